//! Components of plugins, of which the framework knows nothing.

use tyndall::prelude::*;

/// Something to say about an entity that the framework knows nothing of.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub struct Caption {
    pub text: String,
}

/// How far an entity is lifted above its place.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Motion)]
pub struct Lifted {
    pub by: f32,
}

/// Makes [`Caption`] and [`Lifted`] known to scenes, as plugins do.
pub struct Signs;

impl Plugin for Signs {
    fn build(&self, app: &mut App) {
        app.register_type::<Caption>().register_type::<Lifted>();
        app.add_systems(Update, lift.in_set(Stage::Animate));
    }
}

fn lift(mut entities: Query<(&Lifted, &mut Motion)>) {
    for (lifted, mut motion) in &mut entities {
        let up = DVec3::Y * f64::from(lifted.by);
        motion.set_if_neq(Motion(DAffine3::from_translation(up)));
    }
}
