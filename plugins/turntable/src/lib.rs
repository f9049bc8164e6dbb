//! Turns an entity about an axis through the origin of the scene, at a steady rate.
//!
//! On a mesh or volume it makes a turntable; on a camera, a flight around; on a light, a day.
//!
//! ```ron
//! "bunny": ( Mesh: File("bunny.obj"), Turntable: (degrees_per_second: 36.0, axis: (0.0, 1.0, 0.0)) )
//! ```

use tyndall::prelude::*;

/// Turns an entity.
///
/// | field | unit | range | default |
/// |---|---|---|---|
/// | `degrees_per_second` | degrees per second, right-handed about the axis | finite | 36.0 |
/// | `axis` | direction through the scene's origin | not zero | (0, 1, 0) |
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate, @AlsoCalled(&["Spin", "Rotate", "Orbit", "Animation"]))]
#[require(Motion)]
pub struct Turntable {
    /// Rate; positive is right-handed about the axis.
    #[reflect(@Unit("degrees per second"), @AlsoCalled(&["rate", "speed"]))]
    pub degrees_per_second: f32,
    /// Axis through the origin of the scene.
    pub axis: Vec3,
}

impl Default for Turntable {
    fn default() -> Self {
        Self { degrees_per_second: 36.0, axis: Vec3::Y }
    }
}

impl Validate for Turntable {
    fn problems(&self) -> Vec<(&'static str, String)> {
        if self.axis.as_dvec3().length_squared() > 0.0 {
            return Vec::new();
        }
        vec![("axis", "a turntable needs an axis, found (0, 0, 0)".into())]
    }
}

/// Makes [`Turntable`] known to scenes and turns whatever has it.
pub struct TurntablePlugin;

impl Plugin for TurntablePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Turntable>().add_systems(Update, turn.in_set(Stage::Animate));
    }
}

fn turn(time: Res<SceneTime>, mut entities: Query<(&Turntable, &mut Motion)>) {
    for (turntable, mut motion) in &mut entities {
        let angle = (f64::from(turntable.degrees_per_second) * time.seconds).to_radians();
        let rotation = DQuat::from_axis_angle(turntable.axis.as_dvec3().normalize(), angle);
        motion.set_if_neq(Motion(DAffine3::from_quat(rotation)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_takes_x_to_minus_z_about_y() {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).add_plugins(TurntablePlugin);
        let entity = app
            .world_mut()
            .spawn((Mesh::default(), Turntable { degrees_per_second: 45.0, ..Default::default() }))
            .id();
        app.insert_resource(SceneTime { seconds: 2.0 });
        app.update();
        let turned = app.world().get::<Placement>(entity).unwrap().0.transform_vector3(DVec3::X);
        assert!(turned.abs_diff_eq(DVec3::NEG_Z, 1e-12), "{turned}");
    }
}
