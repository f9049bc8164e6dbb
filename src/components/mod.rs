//! What a scene is: plain data, no GPU.
//!
//! Every type here is reflected, so it is written in RON by its short name with its fields (`Phong: (shininess: 60.0)`), is validated by
//! the attributes on its fields ([`Range`], [`Names`], [`NameOf`]) and, where fields depend on each other, by [`Validate`]. Fields that are left out
//! take the values of the type's `Default`. What only an inspector wants to know stands beside those: [`Unit`], [`Slider`], [`Rgb`], [`Direction`],
//! [`Label`], [`ChooseVariant`], and the documentation of each field, which is its tooltip.

mod asset_path;
mod attributes;
mod auto;
mod directional_light;
mod mesh;
mod phong;
mod presentation;
mod ray_cast;
mod scattering_camera;
mod scattering_maps;
mod scene_settings;
mod shading;
mod subsurface;
mod transfer_function;
mod transform;
mod view_camera;
mod volume;
mod volume_lighting;

pub use asset_path::AssetPath;
pub use attributes::{
    AlsoCalled, Leading, NameOf, Names, Range, ReflectValidate, Required, Shorthand, Unit, Untagged, Validate,
};
pub use auto::Auto;
pub use directional_light::DirectionalLight;
pub use mesh::{Mesh, Normals};
pub use phong::Phong;
pub use presentation::{ChooseVariant, Direction, Label, ReflectChooseVariant, Rgb, Slider};
pub use ray_cast::RayCast;
pub(crate) use scattering_camera::aim;
pub use scattering_camera::{ScatteringCamera, ScatteringCameraOf, ScatteringCameras};
pub use scattering_maps::{MapResolution, MapStrategy, SampleRadius, ScatteringMaps};
pub use scene_settings::SceneSettings;
pub use shading::Shading;
pub use subsurface::{DipoleModel, Material, Specular, Subsurface};
pub use transfer_function::{Classification, ControlPoint, IsoValue, LabelColour, Preset, TransferFunction};
pub(crate) use transform::place;
pub use transform::{DataFrame, Motion, Placement, Scale, Transform};
pub use view_camera::{Flat, Framing, Projection, ViewCamera};
pub use volume::{Endian, Interpolation, Place, SampleFormat, Volume};
pub use volume_lighting::VolumeLighting;

use bevy_app::App;

/// Registers every component above, which makes it writable in scene files.
pub(crate) fn register(app: &mut App) {
    app.register_type::<DirectionalLight>()
        .register_type::<Mesh>()
        .register_type::<Phong>()
        .register_type::<RayCast>()
        .register_type::<ScatteringCamera>()
        .register_type::<ScatteringMaps>()
        .register_type::<SceneSettings>()
        .register_type::<Shading>()
        .register_type::<Subsurface>()
        .register_type::<TransferFunction>()
        .register_type::<Transform>()
        .register_type::<ViewCamera>()
        .register_type::<Volume>()
        .register_type::<VolumeLighting>();
}
