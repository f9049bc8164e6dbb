//! How pictures are written, and what each format holds.

use clap::ValueEnum;
use std::path::Path;

/// What a picture, or a sequence of them, is written as.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// As on a screen, 8 bits; with --transparent straight alpha
    Png,
    /// Linear radiance, 32-bit floats; with --transparent premultiplied alpha
    Exr,
    /// As on a screen, bare bytes: red, green, blue (ffmpeg's rgb24); with --transparent straight alpha (rgba)
    Raw,
    /// As on a screen, YUV4MPEG2 for video encoders: 4:4:4, BT.601, limited range
    Y4m,
}

impl Format {
    /// The one that the ending of a file's name says.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_lowercase().as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            "rgb" | "rgba" | "raw" => Some(Self::Raw),
            "y4m" => Some(Self::Y4m),
            _ => None,
        }
    }

    /// Whether it holds what a screen shows, as opposed to radiance.
    pub fn is_encoded(self) -> bool {
        self != Self::Exr
    }

    /// Whether one file holds all frames, one behind the other.
    pub fn is_sequence(self) -> bool {
        matches!(self, Self::Raw | Self::Y4m)
    }

    /// Whether it can say how much of the background a picture hides.
    pub fn has_alpha(self) -> bool {
        self != Self::Y4m
    }
}
