//! Tyndall.
pub mod components;
pub mod scene;
pub mod sources;
/// Stage
#[derive(bevy_ecs::prelude::SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum Stage { /// a
 Animate, /// b
 Place }
