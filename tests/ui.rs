//! Panels as a person uses them: clicks, drags, keys, and what those hear who cannot see.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "ui/inspector.rs"]
mod inspector;
#[path = "ui/light_direction.rs"]
mod light_direction;
#[path = "ui/looks.rs"]
mod looks;
#[path = "ui/panel.rs"]
mod panel;
#[path = "ui/plugin_component.rs"]
mod plugin_component;
#[path = "ui/transfer_function.rs"]
mod transfer_function;
#[path = "ui/transfer_function_extremes.rs"]
mod transfer_function_extremes;
