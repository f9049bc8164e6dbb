//! Structs that Rust writes and shaders read, for the tests that compare the two.
//!
//! Such a struct is declared with the macro `mirror!`, which derives its layout (encase) and lists its fields beside it, so that no
//! test can forget one.

use crate::{passes, view};

/// Declares a struct that a shader reads.
macro_rules! mirror {
    (
        $(#[$meta:meta])*
        $shader:literal:
        $vis:vis struct $name:ident as $wgsl:literal { $($field:ident: $ty:ty,)* }
    ) => {
        $(#[$meta])*
        #[derive(encase::ShaderType, Clone, Debug)]
        $vis struct $name { $(pub $field: $ty,)* }

        impl $name {
            /// What the shader must have too.
            pub(crate) fn mirror() -> $crate::mirrors::Mirror {
                let names = [$(stringify!($field)),*];
                let offset = |index| <Self as encase::ShaderType>::METADATA.offset(index);
                $crate::mirrors::Mirror {
                    shader: $shader,
                    name: $wgsl,
                    size: <Self as encase::ShaderSize>::SHADER_SIZE.get(),
                    fields: names.into_iter().enumerate().map(|(index, name)| (name, offset(index))).collect(),
                }
            }
        }
    };
}
pub(crate) use mirror;

/// A struct as Rust lays it out.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Stem of a shader that reads it.
    pub shader: &'static str,
    /// Its name there.
    pub name: &'static str,
    /// Bytes.
    pub size: u64,
    /// Names and byte offsets of its fields.
    pub fields: Vec<(&'static str, u64)>,
}

/// Every such struct.
pub fn all() -> Vec<Mirror> {
    vec![
        view::FrameUniform::mirror(),
        view::LightUniform::mirror(),
        passes::dimmed_gbuffer::LightViewUniform::mirror(),
        passes::gbuffer::SeenMeshUniform::mirror(),
        passes::medium::MediumUniform::mirror(),
        passes::scattering_gbuffer::MapCameraUniform::mirror(),
        passes::scattering_gbuffer::MapsUniform::mirror(),
        passes::scattered_radiosity::GatheringUniform::mirror(),
        passes::scattered_radiosity::EstimatorUniform::mirror(),
        passes::combine::CombinationUniform::mirror(),
        passes::surface::MeshLook::mirror(),
        passes::light_cells::CellsUniform::mirror(),
        passes::light_volume::SegmentsUniform::mirror(),
        passes::light_volume::medium::ClassifiedUniform::mirror(),
        passes::preclassify::VoxelsUniform::mirror(),
        passes::light_volume::sweep::ColumnsUniform::mirror(),
        passes::light_volume::sweep::SweepUniform::mirror(),
        passes::light_network::levels::LevelUniform::mirror(),
        passes::light_network::directions::FanUniform::mirror(),
        passes::light_network::DiffusionUniform::mirror(),
        passes::scattered_light::SourceUniform::mirror(),
        passes::eye_light::sweep::ScatterSweepUniform::mirror(),
        passes::eye_light::sweep::SliceUniform::mirror(),
        passes::eye_light::EyeSweepUniform::mirror(),
        passes::shared_light::ShareUniform::mirror(),
        passes::summed_light::SummationUniform::mirror(),
        passes::raycast::VolumeInstance::mirror(),
        passes::raycast::PartUniform::mirror(),
        passes::tonemap::DisplayUniform::mirror(),
    ]
}

/// The modules of shaders that are made as the scene needs them, for one that needs all variants: three volumes, of which the sampler
/// interpolates one and the shader another, and which are classified in different ways.
pub fn generated_modules() -> Vec<(&'static str, String)> {
    use crate::components::Classification::{Pre, PreIntegrated};
    use crate::gpu::Filtering::{Sampler, Shader};
    use crate::gpu::Texels::{Colours, Masked, Values};
    use crate::passes::classification::Manner;
    use crate::passes::raycast::Scattered::{Nothing, TowardsEye};
    use crate::passes::voxels::{self, Reading};
    let manners = [
        Manner { classification: Pre, ..Manner::POST },
        Manner { classification: PreIntegrated, ..Manner::POST },
        Manner { is_exact: true, has_surfaces: true, ..Manner::POST },
    ];
    let plain = Reading { filtering: Sampler, texels: Values, is_nearest: false };
    let nearest = Reading { is_nearest: true, ..plain };
    let coloured = Reading { texels: Colours, ..plain };
    let masked = Reading { filtering: Shader, texels: Masked, is_nearest: false };
    let count = passes::light_volume::through::VeilCount { volumes: 2, lights: 1 };
    // Behind the bindings of every shader that has these modules.
    let (volumes, first, classified) = (50, 18, 32);
    let [light_volumes, veils] = passes::light_volume::through::modules(count, Sampler, first);
    vec![
        ("volumes", voxels::module(&[plain, masked, nearest, coloured], volumes)),
        voxels::texels_module(masked),
        passes::lighting::Kinds::all().module(),
        passes::raycast::classifications_module(&manners, classified),
        view::lights_module(4),
        passes::appearance::module(Some(46)),
        light_volumes,
        veils,
        passes::volume_shadow::module(&[true, false], 36),
        passes::raycast::scattered_module(&[TowardsEye, Nothing], 40),
        passes::raycast::parts_module(44),
        passes::raycast::sweeps_module(&[1, 1], &[0, 2]),
        passes::scattered_light::leaning_module(true),
        passes::scattered_radiosity::sampling_module(&Default::default(), 5),
        passes::scattered_radiosity::listing_module(false),
    ]
}
