//! Lists: items are added, removed and moved.

use super::super::icons::{ICON_WIDTH, Icon, icon_button};
use super::super::rows::{label, note};
use super::defaults;
use super::field::Field;
use super::leaf::{copy, whole};
use super::walk::Walk;
use bevy_reflect::list::{DynamicList, List};
use bevy_reflect::{PartialReflect, Reflect};
use egui::Ui;
use std::any::TypeId;

/// As many items as are shown at once.
pub(super) const MOST_ITEMS: usize = 50;

/// What is done to the items of a list.
#[derive(Clone, Copy)]
enum Change {
    Remove(usize),
    /// Exchanges an item with the next.
    Swap(usize),
    Add,
}

impl Walk<'_> {
    pub(super) fn list(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        items: &dyn List,
        list: &dyn PartialReflect,
        item: TypeId,
    ) {
        let first = self.page(ui, items.len());
        let mut change = None;
        for index in first..(first + MOST_ITEMS).min(items.len()) {
            let Some(value) = items.get(index) else { continue };
            self.within(&format!("[{index}]"), |walk| {
                let top = ui.cursor().top();
                walk.node(ui, &field.item(index), value, None);
                change = change.or(walk.buttons(ui, top, index, items.len()));
            });
        }
        let name = format!("Add to {}", self.name());
        self.columns.row(
            ui,
            |ui| {
                label(ui, Default::default());
            },
            |ui| {
                if icon_button(ui, Icon::Add, &name).clicked() {
                    change = Some(Change::Add);
                }
            },
            |_| {},
        );
        if let Some(change) = change {
            match self.changed(items, list, item, field, change) {
                Some(new) => self.edit(new, true),
                None => self.complain(ui, "an item has no default to begin with"),
            }
        }
    }

    /// Buttons that remove and move an item, at the right of its row.
    fn buttons(&self, ui: &mut Ui, top: f32, index: usize, items: usize) -> Option<Change> {
        let height = ui.spacing().interact_size.y;
        let rect = self.columns.behind(top, height, 3.0 * ICON_WIDTH);
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        let builder = egui::UiBuilder::new().id_salt(("buttons", index)).max_rect(rect).layout(layout);
        let mut ui = ui.new_child(builder);
        ui.spacing_mut().item_spacing.x = 0.0;
        let name = self.name();
        let mut change = None;
        if icon_button(&mut ui, Icon::Remove, &format!("Remove {name}")).clicked() {
            change = Some(Change::Remove(index));
        }
        let is_last = index + 1 == items;
        ui.add_enabled_ui(!is_last, |ui| {
            if icon_button(ui, Icon::Down, &format!("Move {name} down")).clicked() {
                change = Some(Change::Swap(index));
            }
        });
        ui.add_enabled_ui(index > 0, |ui| {
            if icon_button(ui, Icon::Up, &format!("Move {name} up")).clicked() {
                change = Some(Change::Swap(index - 1));
            }
        });
        change
    }

    /// Which item is shown first; with buttons to go on where not all are.
    fn page(&mut self, ui: &mut Ui, items: usize) -> usize {
        if items <= MOST_ITEMS {
            return 0;
        }
        let id = self.value_id().with("page");
        let last = (items - 1) / MOST_ITEMS;
        let mut page = ui.data(|data| data.get_temp::<usize>(id)).unwrap_or(0).min(last);
        let name = self.name();
        self.columns.row(
            ui,
            |ui| {
                label(ui, Default::default());
            },
            |ui| {
                if icon_button(ui, Icon::Left, &format!("Earlier items of {name}")).clicked() {
                    page = page.saturating_sub(1);
                }
                if icon_button(ui, Icon::Right, &format!("Later items of {name}")).clicked() {
                    page = (page + 1).min(last);
                }
                let first = page * MOST_ITEMS;
                note(ui, &format!("{first} to {} of {items}", (first + MOST_ITEMS).min(items) - 1));
            },
            |_| {},
        );
        ui.data_mut(|data| data.insert_temp(id, page));
        page * MOST_ITEMS
    }

    fn changed(
        &self,
        items: &dyn List,
        list: &dyn PartialReflect,
        item: TypeId,
        field: &Field,
        change: Change,
    ) -> Option<Box<dyn Reflect>> {
        let mut new: Vec<Box<dyn Reflect>> =
            items.iter().map(|item| copy(item, self.registry)).collect::<Option<_>>()?;
        match change {
            Change::Remove(index) => {
                new.remove(index);
            }
            Change::Swap(index) => new.swap(index, index + 1),
            // One like the last is more often right than a default.
            Change::Add => new.push(match new.last() {
                Some(last) => copy(last.as_partial_reflect(), self.registry)?,
                None => defaults::of_field(item, field, self.registry)?,
            }),
        }
        let mut dynamic = DynamicList::default();
        new.into_iter().for_each(|item| dynamic.push_box(item.into_partial_reflect()));
        whole(&dynamic, list.get_represented_type_info()?, self.registry)
    }
}
