//! Tables of colours for values.

use std::path::Path;

use super::{SourceError, elements::Element, header::unsupported, tags, values::shorts};
use crate::sources::stored::Stored;

/// The colours of the values of a file, as it stores them: red, green, blue.
#[derive(Debug, Clone, Default)]
pub(super) struct Palette {
    /// How many, the value of the first, and bits of each.
    layout: [Vec<u16>; 3],
    /// One number each, or two in a word.
    data: [Vec<u16>; 3],
}

impl Palette {
    /// Takes an element of the table.
    pub fn element(&mut self, element: &Element, big_endian: bool) {
        let numbers = shorts(&element.value, big_endian);
        match element.tag {
            tags::RED_LAYOUT | tags::GREEN_LAYOUT | tags::BLUE_LAYOUT => {
                self.layout[(element.tag - tags::RED_LAYOUT) as usize] = numbers;
            }
            tags::RED | tags::GREEN | tags::BLUE => self.data[(element.tag - tags::RED) as usize] = numbers,
            _ => {}
        }
    }

    /// The colours of values; those outside the table get its ends.
    pub fn colours(&self, path: &Path, values: &Stored, signed: bool) -> Result<Vec<[u8; 4]>, SourceError> {
        let tables =
            [self.table(path, 0, signed)?, self.table(path, 1, signed)?, self.table(path, 2, signed)?];
        let colour = |value: i32| {
            let [red, green, blue] = [0, 1, 2].map(|channel| {
                let (first, table) = &tables[channel];
                let place = value.saturating_sub(*first).clamp(0, table.len() as i32 - 1);
                table[place as usize]
            });
            [red, green, blue, u8::MAX]
        };
        let mut colours = Vec::new();
        macro_rules! colours {
            ($($variant:ident)*) => {
                match values {
                    $(Stored::$variant(values) => {
                        let bytes = 4 * values.len() as u64;
                        let no_memory = |_| SourceError::OutOfMemory { path: path.to_owned(), bytes };
                        colours.try_reserve_exact(values.len()).map_err(no_memory)?;
                        colours.extend(values.iter().map(|value| colour(i32::from(*value))));
                    })*
                    _ => return Err(missing(path)),
                }
            };
        }
        colours!(U8 I8 U16 I16);
        Ok(colours)
    }

    /// The value of the first entry, and all in 8 bits.
    fn table(&self, path: &Path, channel: usize, signed: bool) -> Result<(i32, Vec<u8>), SourceError> {
        let &[count, first, bits] = self.layout[channel].as_slice() else { return Err(missing(path)) };
        // None means more than 16 bits can say.
        let count = if count == 0 { 1 << 16 } else { usize::from(count) };
        let data = &self.data[channel];
        let in_bytes = bits == 8 && data.len() < count;
        let table: Vec<u8> = if in_bytes {
            data.iter().flat_map(|word| word.to_le_bytes()).take(count).collect()
        } else {
            // Some programs write 8 bits into words and say 16.
            let is_low = bits == 8 || data.iter().all(|word| *word < 256);
            data.iter().take(count).map(|word| if is_low { *word as u8 } else { (word >> 8) as u8 }).collect()
        };
        if table.len() < count {
            return Err(missing(path));
        }
        Ok((if signed { i32::from(first as i16) } else { i32::from(first) }, table))
    }
}

fn missing(path: &Path) -> SourceError {
    let found = "its pixels are places in a table of colours that it does not have whole";
    unsupported(path, found, "convert it to RGB")
}
