//! Draws a transfer function over its histogram.

use super::super::colour::shown;
use super::axis::Stretch;
use super::curve::{Curve, Sample, between};
use crate::components::ControlPoint;
use crate::sources::Histogram;
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rangef, Rect, Shape, Stroke, Ui, pos2, vec2};

/// Heights of the picture, of the band of colours below it, and of the numbers below that.
const PICTURE: f32 = 170.0;
const BAND: f32 = 14.0;
const NUMBERS: f32 = 16.0;
/// Space above and below the curve, so that handles at its ends are whole.
const MARGIN: f32 = 9.0;

/// Where in a panel things are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plot {
    /// The picture: histogram, curve, handles.
    pub rect: Rect,
    band: Rect,
    numbers: Rect,
    /// The data values across it.
    pub view: Stretch,
    /// The data values at positions 0 and 1.
    pub domain: (f64, f64),
}

impl Plot {
    /// All the height that it takes.
    pub const HEIGHT: f32 = PICTURE + 3.0 + BAND + NUMBERS;

    pub fn new(whole: Rect, view: Stretch, domain: (f32, f32)) -> Self {
        let below =
            |top: f32, height: f32| Rect::from_min_size(pos2(whole.left(), top), vec2(whole.width(), height));
        let rect = below(whole.top(), PICTURE);
        let band = below(rect.bottom() + 3.0, BAND);
        let numbers = below(band.bottom(), NUMBERS);
        Self { rect, band, numbers, view, domain: (f64::from(domain.0), f64::from(domain.1)) }
    }

    pub fn across(&self) -> Rangef {
        self.rect.x_range()
    }

    pub fn x(&self, value: f64) -> f32 {
        self.view.x(self.across(), value)
    }

    pub fn value_at(&self, x: f32) -> f64 {
        self.view.value(self.across(), x)
    }

    pub fn y(&self, opacity: f32) -> f32 {
        let opacity = if opacity.is_finite() { opacity.clamp(0.0, 1.0) } else { 0.0 };
        egui::lerp(self.rect.bottom() - MARGIN..=self.rect.top() + MARGIN, opacity)
    }

    pub fn opacity_at(&self, y: f32) -> f32 {
        egui::remap_clamp(y, self.rect.top() + MARGIN..=self.rect.bottom() - MARGIN, 1.0..=0.0)
    }

    /// The data value at a position of the domain.
    pub fn value(&self, position: f32) -> f64 {
        self.domain.0 + f64::from(position) * (self.domain.1 - self.domain.0)
    }

    /// The position in the domain of a data value, 0 to 1.
    pub fn position(&self, value: f64) -> f64 {
        let position = (value - self.domain.0) / (self.domain.1 - self.domain.0);
        if position.is_finite() { position.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// How many data values half a point of the picture is wide: finer than that nobody drags.
    pub fn grain(&self) -> f64 {
        0.5 * self.view.width() / f64::from(self.rect.width().max(1.0))
    }

    /// Everything but the handles.
    pub fn draw(
        &self,
        ui: &Ui,
        curve: &Curve,
        points: &[ControlPoint],
        has_iso: bool,
        histogram: Option<(&Histogram, bool)>,
    ) {
        let visuals = ui.visuals();
        ui.painter().rect_filled(self.rect, 3.0, visuals.extreme_bg_color);
        let painter = ui.painter().with_clip_rect(self.rect.intersect(ui.clip_rect()));
        self.outside(&painter, visuals.faint_bg_color);
        self.grid(ui, &painter);
        if let Some((histogram, is_linear)) = histogram {
            // Without transparency, so that bars which overlap do not show.
            let grey = visuals.extreme_bg_color.lerp_to_gamma(visuals.text_color().to_opaque(), 0.28);
            painter.add(Shape::mesh(self.histogram(histogram, is_linear, grey)));
        }
        painter.add(Shape::mesh(self.area(curve)));
        let line = visuals.strong_text_color();
        if has_iso && !points.is_empty() {
            let thin = Stroke::new(1.0, line.gamma_multiply(0.5));
            painter.add(Shape::line(self.lines_between(points), thin));
        }
        painter.add(Shape::line(self.line(curve), Stroke::new(1.5, line)));
        for layer in &curve.layers {
            let x = self.x(layer.value);
            let stroke = Stroke::new(2.0, shown(layer.colour));
            painter.line_segment([pos2(x, self.y(0.0)), pos2(x, self.y(layer.opacity))], stroke);
        }
        let band = ui.painter().with_clip_rect(self.band.intersect(ui.clip_rect()));
        band.add(Shape::mesh(self.colours(curve)));
    }

    /// What lies outside the domain looks like its ends, and is set off.
    fn outside(&self, painter: &Painter, colour: Color32) {
        let (low, high) = (self.x(self.domain.0), self.x(self.domain.1));
        let part = |from: f32, to: f32| {
            Rect::from_min_max(pos2(from, self.rect.top()), pos2(to.max(from), self.rect.bottom()))
        };
        painter.rect_filled(part(self.rect.left(), low), 0.0, colour);
        painter.rect_filled(part(high, self.rect.right()), 0.0, colour);
        for x in [low, high] {
            painter.vline(x, self.rect.y_range(), Stroke::new(1.0, colour.gamma_multiply(2.0)));
        }
    }

    fn grid(&self, ui: &Ui, painter: &Painter) {
        let stroke = Stroke::new(1.0, ui.visuals().weak_text_color().gamma_multiply(0.18));
        for opacity in [0.0, 0.25, 0.5, 0.75, 1.0] {
            painter.hline(self.across(), self.y(opacity), stroke);
        }
        let font = FontId::proportional(10.0);
        let colour = ui.visuals().weak_text_color();
        for (opacity, text) in [(0.0, "0"), (0.5, "0.5"), (1.0, "1")] {
            let at = pos2(self.rect.left() + 3.0, self.y(opacity) - 1.0);
            let align = if opacity == 1.0 { Align2::LEFT_TOP } else { Align2::LEFT_BOTTOM };
            painter.text(at, align, text, font.clone(), colour);
        }
        let most = (self.rect.width() / 56.0) as usize;
        let mut free_from = f32::NEG_INFINITY;
        for (value, text) in self.view.ticks(most.max(2)) {
            let x = self.x(value);
            painter.vline(x, self.rect.y_range(), stroke);
            let galley = ui.painter().layout_no_wrap(text, font.clone(), colour);
            let half = 0.5 * galley.size().x;
            let most = (self.rect.right() - half).max(self.rect.left() + half);
            let centre = x.clamp(self.rect.left() + half, most);
            // Numbers do not touch each other.
            if centre - half > free_from {
                free_from = centre + half + 6.0;
                ui.painter().galley(pos2(centre - half, self.numbers.top() + 2.0), galley, colour);
            }
        }
    }

    fn histogram(&self, histogram: &Histogram, is_linear: bool, colour: Color32) -> Mesh {
        let mut mesh = Mesh::default();
        let most = histogram.bins.iter().copied().max().unwrap_or(0);
        let height = |samples: u64| {
            let (samples, most) = (samples as f64, most as f64);
            (if is_linear { samples / most } else { samples.ln_1p() / most.ln_1p() }) as f32
        };
        let (low, high) = (f64::from(histogram.range.0), f64::from(histogram.range.1));
        let width = (high - low) / histogram.bins.len().max(1) as f64;
        for (bin, samples) in histogram.bins.iter().enumerate().filter(|(_, samples)| **samples > 0) {
            let (from, to) = (low + bin as f64 * width, low + (bin as f64 + 1.0) * width);
            let (left, mut right) = (self.x(from), self.x(to));
            if right < self.rect.left() || left > self.rect.right() {
                continue;
            }
            // Of data that are all the same, too, something is seen.
            right = right.max(left + 1.5);
            let (top, bottom) = (self.y(height(*samples)), self.y(0.0));
            mesh.add_colored_rect(Rect::from_min_max(pos2(left, top), pos2(right, bottom)), colour);
        }
        mesh
    }

    /// What is seen at every second point across.
    fn columns(&self, curve: &Curve) -> Vec<(f32, Sample)> {
        let columns = (self.rect.width() / 2.0).clamp(1.0, 4000.0) as usize;
        let x = |column: usize| self.rect.left() + self.rect.width() * column as f32 / columns as f32;
        (0..=columns).filter_map(|column| Some((x(column), curve.at(self.value_at(x(column)))?))).collect()
    }

    fn area(&self, curve: &Curve) -> Mesh {
        let across = self.columns(curve);
        strip(across.iter().map(|(x, sample)| {
            let colour = shown(sample.colour).gamma_multiply(0.45);
            [pos2(*x, self.y(sample.opacity)), pos2(*x, self.y(0.0))].map(|pos| (pos, colour))
        }))
    }

    fn colours(&self, curve: &Curve) -> Mesh {
        let across = self.columns(curve);
        strip(across.iter().map(|(x, sample)| {
            let colour = shown(sample.colour);
            [pos2(*x, self.band.top()), pos2(*x, self.band.bottom())].map(|pos| (pos, colour))
        }))
    }

    /// The curve through every entry of the table that is in view.
    fn line(&self, curve: &Curve) -> Vec<Pos2> {
        let ends = [self.view.low, self.view.high].map(|value| curve.at(value));
        let within = curve.samples.iter().filter(|sample| self.view.contains(sample.value)).copied();
        let samples = ends[0].into_iter().chain(within).chain(ends[1]);
        samples.map(|sample| pos2(self.x(sample.value), self.y(sample.opacity))).collect()
    }

    fn lines_between(&self, points: &[ControlPoint]) -> Vec<Pos2> {
        let finite = points.iter().filter(|point| point.0.is_finite());
        let inner = finite.map(|point| pos2(self.x(self.value(point.0)), self.y(point.2)));
        let end = |value: f64| pos2(self.x(value), self.y(between(points, self.position(value)).2));
        std::iter::once(end(self.view.low)).chain(inner).chain([end(self.view.high)]).collect()
    }

    /// What is at the pointer, in words.
    pub fn readout(&self, ui: &Ui, curve: &Curve, pointer: Pos2, histogram: Option<&Histogram>) {
        let value = self.value_at(pointer.x);
        let Some(sample) = curve.at(value) else { return };
        let digits = 10f64.powf(self.grain().log10().floor());
        let number = super::super::number::short(super::super::number::round_to(value, digits));
        let mut text = format!("{number}   opacity {:.3}", sample.opacity);
        if let Some(samples) = histogram.and_then(|histogram| samples_at(histogram, value)) {
            text.push_str(&format!("   {samples} samples"));
        }
        let at = self.rect.right_top() + vec2(-5.0, 3.0);
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(11.0), ui.visuals().text_color());
        let rect = Align2::RIGHT_TOP.anchor_size(at, galley.size());
        ui.painter().rect_filled(rect.expand(2.0), 2.0, ui.visuals().extreme_bg_color.gamma_multiply(0.8));
        ui.painter().galley(rect.min, galley, ui.visuals().text_color());
    }
}

/// How many samples share a bin with this value.
fn samples_at(histogram: &Histogram, value: f64) -> Option<u64> {
    let (low, high) = (f64::from(histogram.range.0), f64::from(histogram.range.1));
    let share = (value - low) / (high - low);
    let bin = (share * histogram.bins.len() as f64) as usize;
    (0.0..=1.0).contains(&share).then(|| histogram.bins.get(bin.min(histogram.bins.len() - 1)).copied())?
}

/// Pairs of points, joined each with the next.
fn strip(pairs: impl Iterator<Item = [(Pos2, Color32); 2]>) -> Mesh {
    let mut mesh = Mesh::default();
    for (pos, color) in pairs.flatten() {
        mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color });
    }
    for first in (2..mesh.vertices.len() as u32).step_by(2).map(|next| next - 2) {
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 1, first + 2, first + 3);
    }
    mesh
}
