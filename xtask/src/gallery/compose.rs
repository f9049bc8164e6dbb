//! Pictures in rows and columns, each over its label.

use std::convert::Infallible;

use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, ascii};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::prelude::{DrawTarget, Drawable, OriginDimensions, Pixel, Point, Size};
use embedded_graphics::text::{Baseline, Text};
use image::{Rgb, RgbImage, imageops};

const FONT: &MonoFont<'_> = &ascii::FONT_10X20;
const GAP: u32 = 8;
/// Of a line of letters.
const LINE: u32 = 28;
const PAPER: Rgb<u8> = Rgb([38, 40, 44]);
const INK: Rgb888 = Rgb888::new(225, 225, 220);

/// The sheet of pictures of equal size.
pub fn sheet(title: &str, pictures: &[(String, RgbImage)], columns: usize) -> RgbImage {
    let (width, height) = pictures.first().map_or((0, 0), |(_, picture)| picture.dimensions());
    let (step_x, step_y) = (width + GAP, height + LINE + GAP);
    let rows = pictures.len().div_ceil(columns.max(1)) as u32;
    let size = (columns as u32 * step_x + GAP, LINE + rows * step_y + GAP);
    let mut sheet = RgbImage::from_pixel(size.0, size.1, PAPER);
    write(&mut sheet, title, GAP, GAP / 2, size.0 - 2 * GAP);
    for (index, (label, picture)) in pictures.iter().enumerate() {
        let x = GAP + (index % columns) as u32 * step_x;
        let y = LINE + GAP + (index / columns) as u32 * step_y;
        imageops::replace(&mut sheet, picture, x.into(), y.into());
        write(&mut sheet, label, x, y + height + GAP / 2, width);
    }
    sheet
}

/// As much of the text as there is room for.
fn write(sheet: &mut RgbImage, text: &str, x: u32, y: u32, width: u32) {
    let room = (width / (FONT.character_size.width + FONT.character_spacing)) as usize;
    let text: String = text.chars().take(room).collect();
    let place = Point::new(x as i32, y as i32);
    let style = MonoTextStyle::new(FONT, INK);
    match Text::with_baseline(&text, place, style, Baseline::Top).draw(&mut Paper(sheet)) {
        Ok(_) => (),
        Err(never) => match never {},
    }
}

/// What letters are drawn on.
struct Paper<'a>(&'a mut RgbImage);

impl OriginDimensions for Paper<'_> {
    fn size(&self) -> Size {
        Size::new(self.0.width(), self.0.height())
    }
}

impl DrawTarget for Paper<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(place, colour) in pixels {
            let (Ok(x), Ok(y)) = (u32::try_from(place.x), u32::try_from(place.y)) else { continue };
            if let Some(pixel) = self.0.get_pixel_mut_checked(x, y) {
                *pixel = Rgb([colour.r(), colour.g(), colour.b()]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_lies_over_its_label() {
        let picture = |level| RgbImage::from_pixel(40, 30, Rgb([level; 3]));
        let pictures =
            [("a".to_owned(), picture(100)), (String::new(), picture(150)), ("c".to_owned(), picture(200))];
        let sheet = sheet("title", &pictures, 2);
        assert_eq!(sheet.dimensions(), (8 + 2 * 48, 28 + 2 * 66 + 8));
        let level = |x, y| sheet.get_pixel(x, y).0[0];
        assert_eq!((level(28, 50), level(76, 50), level(28, 116)), (100, 150, 200));
        let has_ink = |x: u32, y: u32| (x..x + 40).any(|x| (y..y + 24).any(|y| level(x, y) == 225));
        assert!(has_ink(8, 66) && has_ink(8, 132));
        assert!(!has_ink(56, 66));
    }

    #[test]
    fn long_labels_stay_on_their_line() {
        let pictures = [("far too long for this".to_owned(), RgbImage::new(20, 20))];
        let sheet = sheet("a title that is longer", &pictures, 1);
        let edge = |y| (28..36).map(move |x| (x, y));
        assert!((0..sheet.height()).flat_map(edge).all(|(x, y)| *sheet.get_pixel(x, y) == PAPER));
    }
}
