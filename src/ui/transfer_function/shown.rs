//! The function that is shown in a frame, and what is changed of it.

use super::super::edited::{Edited, settle};
use super::TransferFunctionData;
use crate::components::{ControlPoint, IsoValue, TransferFunction};
use bevy_reflect::Reflect;
use egui::{Id, Ui};

/// The function that is shown, and what a person changed of it so far.
pub(super) struct Shown<'a> {
    pub id: Id,
    /// Whose it is.
    pub name: &'a str,
    pub function: &'a TransferFunction,
    pub data: &'a TransferFunctionData<'a>,
    /// The points in force, be they written or not.
    pub points: Vec<ControlPoint>,
    pub edits: Vec<Edited>,
}

impl Shown<'_> {
    fn put(&mut self, path: String, value: Box<dyn Reflect>, finished: bool) {
        self.edits.push(Edited { path, value, finished });
    }

    /// Changes a point, or finishes the gesture that has been changing it.
    pub fn set_point(&mut self, ui: &Ui, index: usize, new: Option<ControlPoint>) {
        let Some(old) = self.points.get(index).copied() else { return };
        let Some(finished) = settle(ui, self.id.with(("point", index)), new.is_some()) else { return };
        let point = new.unwrap_or(old);
        if self.function.points.is_empty() {
            // The ramp that stands where nothing is written; it is written from now on.
            let mut points = self.points.clone();
            points[index] = point;
            self.put("points".into(), Box::new(points), finished);
        } else {
            self.put(format!("points[{index}]"), Box::new(point), finished);
        }
    }

    /// Changes an iso value, or finishes the gesture that has been changing it.
    pub fn set_iso(&mut self, ui: &Ui, index: usize, new: Option<IsoValue>) {
        let Some(old) = self.function.iso.get(index).copied() else { return };
        let Some(finished) = settle(ui, self.id.with(("iso", index)), new.is_some()) else { return };
        self.put(format!("iso[{index}]"), Box::new(new.unwrap_or(old)), finished);
    }

    /// Puts a point where it belongs by its position. Its index.
    pub fn add_point(&mut self, point: ControlPoint) -> usize {
        let mut points = self.points.clone();
        let index = points.partition_point(|other| other.0 <= point.0);
        points.insert(index, point);
        if self.function.labels.is_empty() {
            self.put("points".into(), Box::new(points), true);
        } else {
            // A curve and labels exclude each other.
            self.put_all(TransferFunction { points, labels: Vec::new(), ..self.function.clone() });
        }
        index
    }

    /// Adds an iso value; what is seen beside it stays. Its index.
    pub fn add_iso(&mut self, iso: IsoValue) -> usize {
        let mut all = self.function.iso.clone();
        all.push(iso);
        let index = all.len() - 1;
        if self.function.points.is_empty() && self.function.iso.is_empty() {
            // With an iso value the ramp that nothing stands for would be gone, and labels go.
            let (points, labels) = (self.points.clone(), Vec::new());
            let whole = TransferFunction { points, iso: all, labels, ..self.function.clone() };
            self.put_all(whole);
        } else {
            self.put("iso".into(), Box::new(all), true);
        }
        index
    }

    /// Whether nothing would be left to see but the ramp that stands for nothing.
    pub fn is_last(&self) -> bool {
        self.points.len() + self.function.iso.len() <= 1
    }

    pub fn remove_point(&mut self, index: usize) {
        let mut points = self.points.clone();
        if index < points.len() {
            points.remove(index);
            self.put("points".into(), Box::new(points), true);
        }
    }

    pub fn remove_iso(&mut self, index: usize) {
        let mut all = self.function.iso.clone();
        if index < all.len() {
            all.remove(index);
            self.put("iso".into(), Box::new(all), true);
        }
    }

    /// Changes the domain, or finishes the gesture that has been changing it.
    pub fn set_domain(&mut self, ui: &Ui, new: Option<crate::components::Auto<glam::Vec2>>) {
        if let Some(finished) = settle(ui, self.id.with("domain"), new.is_some()) {
            self.put("domain".into(), Box::new(new.unwrap_or(self.function.domain)), finished);
        }
    }

    /// Exchanges the whole function.
    pub fn put_all(&mut self, function: TransferFunction) {
        self.put(String::new(), Box::new(function), true);
    }
}
