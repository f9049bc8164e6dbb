//! What a DICOM file says of its frames, one by one or of all at once.

use glam::DVec3;

use super::{
    elements::Element,
    tags,
    values::{Unreadable, exactly, first, numbers, text, whole},
};

/// What may be said of one frame or of all.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Attributes {
    /// Where the first pixel is in the patient: left, posterior, superior, mm.
    pub position: Option<DVec3>,
    /// The directions in which columns and rows count.
    pub orientation: Option<[DVec3; 2]>,
    /// Distance of pixel centres along y and x, mm.
    pub spacing: Option<[f64; 2]>,
    /// Distance of slices, mm; negative where the stack goes against its normal.
    pub between: Option<f64>,
    /// How thick a slice is, mm.
    pub thickness: Option<f64>,
    /// Slope and intercept of the values.
    pub slope: Option<f64>,
    /// Added to the values.
    pub intercept: Option<f64>,
    /// The middle and the width of the values that are to be seen.
    pub window: [Option<f64>; 2],
    /// The segment that it is of.
    pub segment: Option<i64>,
    /// The stack that it is in.
    pub stack: Option<String>,
    /// Its place in time.
    pub time: Option<i64>,
}

impl Attributes {
    /// Takes an element of a file, or of a sequence that is about frames.
    ///
    /// # Errors
    ///
    /// If it is one of these and cannot be understood.
    pub fn element(&mut self, element: &Element, big_endian: bool) -> Result<(), Unreadable> {
        let first = || first(element, big_endian);
        match element.tag {
            tags::POSITION => {
                self.position = exactly(element, big_endian)?.map(DVec3::from_array).or(self.position);
            }
            tags::ORIENTATION => {
                let axes = exactly::<6>(element, big_endian)?
                    .map(|[a, b, c, d, e, f]| [DVec3::new(a, b, c), DVec3::new(d, e, f)]);
                // Zeros are how some programs write that they do not know.
                self.orientation =
                    axes.filter(|axes| axes.iter().any(|axis| *axis != DVec3::ZERO)).or(self.orientation);
            }
            tags::SPACING => self.spacing = pair(element, big_endian)?.or(self.spacing),
            tags::BETWEEN => self.between = first()?.or(self.between),
            tags::THICKNESS => self.thickness = first()?.or(self.thickness),
            tags::SLOPE => self.slope = first()?.or(self.slope),
            tags::INTERCEPT => self.intercept = first()?.or(self.intercept),
            tags::WINDOW_CENTER => self.window[0] = first()?,
            tags::WINDOW_WIDTH => self.window[1] = first()?,
            tags::REFERENCED_SEGMENT => self.segment = whole(element, big_endian)?,
            tags::STACK => self.stack = Some(text(&element.value)),
            tags::TEMPORAL | tags::TEMPORAL_INDEX => self.time = whole(element, big_endian)?,
            _ => {}
        }
        Ok(())
    }

    /// These, and of `others` what they do not say.
    pub fn or(&self, others: &Self) -> Self {
        Self {
            position: self.position.or(others.position),
            orientation: self.orientation.or(others.orientation),
            spacing: self.spacing.or(others.spacing),
            between: self.between.or(others.between),
            thickness: self.thickness.or(others.thickness),
            slope: self.slope.or(others.slope),
            intercept: self.intercept.or(others.intercept),
            window: if self.window.contains(&None) { others.window } else { self.window },
            segment: self.segment.or(others.segment),
            stack: self.stack.clone().or_else(|| others.stack.clone()),
            time: self.time.or(others.time),
        }
    }

    /// The values that are to be seen, scaled, from the least to the greatest.
    pub fn window(&self) -> Option<(f32, f32)> {
        let [Some(middle), Some(width)] = self.window else { return None };
        let (low, high) = ((middle - width / 2.0) as f32, (middle + width / 2.0) as f32);
        (low < high && low.is_finite() && high.is_finite()).then_some((low, high))
    }
}

/// Two numbers, or one for both.
pub(super) fn pair(element: &Element, big_endian: bool) -> Result<Option<[f64; 2]>, Unreadable> {
    match numbers(element, big_endian)?.as_deref() {
        Some(&[both]) => Ok(Some([both; 2])),
        _ => exactly(element, big_endian),
    }
}

/// What cannot be understood of these matters wherever it is read; of others only where nothing better is known.
pub(super) fn always_matters(tag: u32) -> bool {
    matches!(
        tag,
        tags::POSITION
            | tags::ORIENTATION
            | tags::SPACING
            | tags::SLOPE
            | tags::INTERCEPT
            | tags::FRAMES
            | tags::OFFSETS
            | tags::DOSE_SCALING
            | tags::REFERENCED_SEGMENT
            | tags::SEGMENT
            | tags::SLICE_VECTOR
    )
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn take(attributes: &mut Attributes, tag: u32, value: &str) {
        attributes.element(&Element::of(tag, b"DS", value.as_bytes()), false).unwrap();
    }

    #[test]
    fn what_a_frame_does_not_say_comes_from_all() {
        let (mut frame, mut all) = (Attributes::default(), Attributes::default());
        take(&mut all, tags::SPACING, "0.5");
        take(&mut all, tags::SLOPE, "2");
        take(&mut all, tags::WINDOW_CENTER, "40\\300");
        take(&mut all, tags::WINDOW_WIDTH, "400\\1500");
        take(&mut all, tags::ORIENTATION, "0\\0\\0\\0\\0\\0");
        take(&mut frame, tags::SLOPE, "3,5");
        take(&mut frame, tags::WINDOW_CENTER, "1");
        let merged = frame.or(&all);
        assert_eq!((merged.spacing, merged.slope), (Some([0.5, 0.5]), Some(3.5)));
        assert_eq!((merged.window(), merged.orientation), (Some((-160.0, 240.0)), None));
        take(&mut all, tags::WINDOW_WIDTH, "0");
        assert_eq!(all.window(), None);
    }
}
