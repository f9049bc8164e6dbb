//! The description that microscopes write: OME's XML (<https://docs.openmicroscopy.org/ome-model/6.3.1/ome-tiff/specification.html>).

use quick_xml::{
    Reader, XmlVersion,
    events::{BytesStart, Event},
};

use super::Description;
use crate::sources::{nrrd, shape::Side};

/// What OME's XML says of the pages of the first image; `None` if it is none.
pub(super) fn described(text: &str, pages: u64) -> Option<Description> {
    let mut xml = Reader::from_str(text);
    let mut is_ome = false;
    loop {
        match xml.read_event().ok()? {
            Event::Start(element) | Event::Empty(element) => match element.local_name().as_ref() {
                b"OME" => is_ome = true,
                b"Pixels" if is_ome => return Some(of_pixels(&element, pages)),
                _ => {}
            },
            Event::Eof => return None,
            _ => {}
        }
    }
}

fn of_pixels(element: &BytesStart, pages: u64) -> Description {
    let written = |name: &str| {
        let attribute = element.try_get_attribute(name).ok()??;
        attribute.normalized_value(XmlVersion::Implicit1_0).ok().map(String::from)
    };
    let mut described = Description::default();
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let unit = written(&format!("PhysicalSize{name}Unit")).unwrap_or_else(|| "µm".to_owned());
        let size = written(&format!("PhysicalSize{name}")).and_then(|size| size.parse().ok());
        let size = size.filter(|size: &f64| size.is_finite() && *size > 0.0);
        described.spacing[axis] =
            size.zip(nrrd::millimetres(&unit)).map(|(size, millimetres)| size * millimetres);
    }
    let count =
        |name: char| written(&format!("Size{name}")).and_then(|count| count.parse().ok()).unwrap_or(1_u64);
    let order = written("DimensionOrder").unwrap_or_default();
    // Channels of one page are not pages.
    let per_page = |name: char| if name == 'C' { count('C') } else { 1 };
    let sides = |merged: bool| -> Vec<Side> {
        let side = |name: char| match name {
            'Z' => Some(Side::space(count('Z'))),
            'C' if merged => None,
            'C' => Some(Side::components(count('C'), "channels")),
            'T' => Some(Side::entries(count('T'), "time points")),
            _ => None,
        };
        order.chars().skip(2).filter_map(side).collect()
    };
    let made = |sides: &[Side]| sides.iter().try_fold(1_u64, |all, side| all.checked_mul(side.samples));
    for merged in [false, true] {
        let sides = sides(merged);
        if sides.len() + usize::from(merged) == 3
            && made(&sides) == Some(pages)
            && (!merged || per_page('C') > 1)
        {
            described.stack = sides;
            return described;
        }
    }
    described.notes.push(format!(
        "its description counts {} x {} x {} pages (z, channels, time), but {pages} are there; they are taken as slices",
        count('Z'),
        count('C'),
        count('T')
    ));
    described
}
