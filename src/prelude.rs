//! What a plugin wants to have at hand: `use tyndall::prelude::*;`.

pub use crate::components::*;
pub use crate::gpu::{Gpu, GpuOptions};
pub use crate::report::Report;
pub use crate::{Picture, SceneTime, Stage, TyndallPlugins};
pub use bevy_app::prelude::{App, Plugin, PluginGroup, Update};
pub use bevy_ecs;
pub use bevy_ecs::prelude::*;
pub use bevy_reflect;
pub use bevy_reflect::Reflect;
pub use bevy_reflect::std_traits::ReflectDefault;
pub use glam::{DAffine3, DQuat, DVec3, UVec2, UVec3, Vec2, Vec3};
