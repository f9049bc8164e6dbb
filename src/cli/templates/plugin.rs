//! A plugin for Tyndall: a component of its own, writable in scenes, and a system that acts on it.
//!
//! `cargo run -- render scene.ron -o bob.png --frames 0..25` draws `scene.ron` with it.

use tyndall::prelude::*;

/// Moves an entity up and down.
///
/// | field | unit | default |
/// |---|---|---|
/// | `height` | scene units to either side | 0.5 |
/// | `seconds` | duration of one swing | 2.0 |
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Motion)]
pub struct Bob {
    /// Scene units to either side.
    pub height: f32,
    /// Duration of one swing.
    #[reflect(@Range::positive())]
    pub seconds: f32,
}

impl Default for Bob {
    fn default() -> Self {
        Self { height: 0.5, seconds: 2.0 }
    }
}

/// Makes `Bob` known to scenes and moves whatever has it.
pub fn bob_plugin(app: &mut App) {
    app.register_type::<Bob>().add_systems(Update, swing.in_set(Stage::Animate));
}

fn swing(time: Res<SceneTime>, mut entities: Query<(&Bob, &mut Motion)>) {
    for (bob, mut motion) in &mut entities {
        let phase = time.seconds / f64::from(bob.seconds) * std::f64::consts::TAU;
        let offset = DVec3::new(0.0, f64::from(bob.height) * phase.sin(), 0.0);
        motion.set_if_neq(Motion(DAffine3::from_translation(offset)));
    }
}

/// The whole command line of Tyndall, with this plugin in it.
fn main() -> std::process::ExitCode {
    tyndall::cli::run(bob_plugin)
}
