//! A picture at half, a quarter, … of its size, so that what is seen from afar does not flicker.

use crate::sources::mesh::TextureImage;
use std::sync::LazyLock;

/// A picture at one of its sizes: red, green, blue as sRGB encodes them, and opacity, row by row from the top.
pub(super) struct Level {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[u8; 4]>,
}

/// A picture at no more than `most` texels a side, and at all smaller sizes down to one texel. Means are of light, not of its encoding.
pub(super) fn levels(image: &TextureImage, most: u32) -> Vec<Level> {
    let mut levels = vec![Level { width: image.width, height: image.height, texels: image.texels.clone() }];
    while let Some(last) = levels.last().filter(|last| last.width > 1 || last.height > 1) {
        let half = last.halved();
        if last.width > most || last.height > most {
            levels.clear();
        }
        levels.push(half);
    }
    levels
}

/// Steps to which light is rounded before it is encoded: the darkest of sRGB differ by a third of one.
const STEPS: usize = 8192;

/// Light of each encoded value.
static DECODED: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|encoded| {
        let value = encoded as f32 / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    })
});

/// Encoded value of each step of light.
static ENCODED: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let encoded = |step: usize| {
        let light = step as f32 / (STEPS - 1) as f32;
        let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
        (255.0 * value).round() as u8
    };
    (0..STEPS).map(encoded).collect()
});

impl Level {
    fn halved(&self) -> Self {
        let [width, height] = [self.width, self.height].map(|side| (side / 2).max(1));
        let texels =
            (0..height).flat_map(|row| (0..width).map(move |column| self.mean(column, row))).collect();
        Self { width, height, texels }
    }

    /// The mean of the four texels that one of half the size covers.
    fn mean(&self, column: u32, row: u32) -> [u8; 4] {
        let texel = |x: u32, y: u32| {
            let [x, y] = [(2 * column + x).min(self.width - 1), (2 * row + y).min(self.height - 1)];
            self.texels[y as usize * self.width as usize + x as usize]
        };
        let four = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
        std::array::from_fn(|channel| {
            let values = four.map(|texel| texel[channel]);
            if channel == 3 {
                return ((values.map(u16::from).iter().sum::<u16>() + 2) / 4) as u8;
            }
            let light = values.map(|value| DECODED[usize::from(value)]).iter().sum::<f32>() / 4.0;
            ENCODED[(light * (STEPS - 1) as f32).round() as usize]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_of_light() {
        let (black, white) = ([0, 0, 0, 255], [255; 4]);
        let image = TextureImage { width: 4, height: 1, texels: vec![black, white, white, white] };
        let levels = levels(&image, 4096);
        let sizes: Vec<_> = levels.iter().map(|level| (level.width, level.height)).collect();
        assert_eq!(sizes, [(4, 1), (2, 1), (1, 1)]);
        // Half the light is encoded as 188.
        assert_eq!(levels[1].texels, [[188, 188, 188, 255], white]);
        assert_eq!(levels[2].texels, [[225, 225, 225, 255]]);
    }

    #[test]
    fn what_an_adapter_does_not_take_is_left_out() {
        let image = TextureImage { width: 20, height: 3, texels: vec![[9, 9, 9, 9]; 60] };
        let sizes: Vec<_> = levels(&image, 8).iter().map(|level| (level.width, level.height)).collect();
        assert_eq!(sizes, [(5, 1), (2, 1), (1, 1)]);
        assert_eq!(
            DECODED
                .iter()
                .map(|light| ENCODED[(light * (STEPS - 1) as f32).round() as usize])
                .collect::<Vec<_>>(),
            (0..=255).collect::<Vec<u8>>()
        );
    }
}
