//! Which variant of what an adapter gets: the one place that decides by features.

use super::Gpu;
use crate::sources::SampleFormat;

/// How a volume is kept on the GPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeFormat {
    /// Format of the texels.
    pub texture: wgpu::TextureFormat,
    /// What is in each.
    pub texels: Texels,
    /// Who interpolates between them.
    pub filtering: Filtering,
    /// Data value = texel x `scale` + `offset`.
    pub scale: f32,
    /// See `scale`.
    pub offset: f32,
}

/// What a texel of a volume is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texels {
    /// A value.
    Values,
    /// A value and 1, or 0 and 0 where there is none: interpolated, the one over the other is the mean of the values that there are.
    Masked,
    /// Red, green and blue as sRGB encodes them, 0 to 255, times opacity, and opacity. The value is the luminance.
    Colours,
}

/// Who interpolates between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filtering {
    /// The sampler.
    Sampler,
    /// The shader, with eight loads: where the adapter cannot filter 32-bit floats.
    Shader,
}

impl Filtering {
    fn who(self) -> &'static str {
        match self {
            Self::Sampler => "sampler",
            Self::Shader => "shader",
        }
    }
}

impl VolumeFormat {
    /// The format that each type of sample gets on this adapter, by name.
    pub fn all(gpu: &Gpu) -> std::collections::BTreeMap<String, String> {
        let kinds = [
            SampleFormat::U8,
            SampleFormat::I8,
            SampleFormat::U16,
            SampleFormat::I16,
            SampleFormat::F32,
            SampleFormat::Rgba8,
        ];
        let describe =
            |format: Self| format!("{:?}, filtered by the {}", format.texture, format.filtering.who());
        kinds
            .into_iter()
            .map(|kind| (format!("{kind:?}"), describe(Self::choose(gpu, kind, false))))
            .collect()
    }

    /// The narrowest format that holds the samples exactly and filters them as exactly as the adapter can.
    ///
    /// Software adapters filter 8-bit normalised texels in 8-bit fixed point, which shows as banding; they filter half floats in
    /// full precision, and those hold 8-bit integers exactly. Signed integers are stored shifted, since a signed normalised format maps
    /// its two lowest values to one. `is_masked` says that some samples are missing: then each texel says of its own whether it is one.
    pub fn choose(gpu: &Gpu, samples: SampleFormat, is_masked: bool) -> Self {
        use wgpu::TextureFormat as Format;
        let (low, steps) = match samples {
            SampleFormat::U8 => (0.0, 255.0),
            SampleFormat::I8 => (-128.0, 255.0),
            SampleFormat::U16 => (0.0, 65535.0),
            SampleFormat::I16 => (-32768.0, 65535.0),
            SampleFormat::F32 | SampleFormat::Rgba8 => (0.0, 1.0),
        };
        let texels = Texels::Values;
        let exact =
            |texture| Self { texture, texels, filtering: Filtering::Sampler, scale: 1.0, offset: 0.0 };
        let normalised = |texture| Self { scale: steps, offset: low, ..exact(texture) };
        let floats = match is_masked {
            true => Self { texels: Texels::Masked, ..exact(Format::Rg32Float) },
            false => exact(Format::R32Float),
        };
        match samples {
            // Times opacity colours would have too few steps left in 8 bits.
            SampleFormat::Rgba8 => Self { texels: Texels::Colours, ..exact(Format::Rgba16Float) },
            SampleFormat::U8 | SampleFormat::I8 if gpu.is_software() => exact(Format::R16Float),
            SampleFormat::U8 | SampleFormat::I8 => normalised(Format::R8Unorm),
            SampleFormat::U16 | SampleFormat::I16 if gpu.has(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM) => {
                normalised(Format::R16Unorm)
            }
            _ if gpu.has(wgpu::Features::FLOAT32_FILTERABLE) => floats,
            _ => Self { filtering: Filtering::Shader, ..floats },
        }
    }
}
