//! Texts that are changed when they are complete: with Enter, or when something else is chosen.

use egui::{Id, Key, Response, TextEdit, Ui, vec2};
use std::path::{Path, PathBuf};

/// A line of text. Says what it became once that is complete; Escape leaves it as it was.
pub(super) fn line(ui: &mut Ui, id: Id, name: &str, text: &str, width: f32) -> (Response, Option<String>) {
    let id = id.with("text");
    // What is typed and not complete yet, and what it is typed over.
    let mut typed = ui
        .data(|data| data.get_temp::<(String, String)>(id))
        .filter(|(_, before)| before == text)
        .map_or_else(|| text.to_owned(), |(typed, _)| typed);
    let size = vec2(width, ui.spacing().interact_size.y);
    let edit = TextEdit::singleline(&mut typed).id(id).align(egui::Align2::LEFT_CENTER);
    let response = ui.add_sized(size, edit).accessible_name(name);
    let is_complete = response.lost_focus() && !ui.input(|input| input.key_pressed(Key::Escape));
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, (typed, text.to_owned())));
        return (response, None);
    }
    ui.data_mut(|data| data.remove::<(String, String)>(id));
    (response, Some(typed).filter(|typed| is_complete && typed != text))
}

/// Whether a file is there, looked up once a second.
pub(super) fn exists(ui: &Ui, path: &Path) -> bool {
    let id = Id::unique(("file exists", path));
    let now = ui.input(|input| input.time);
    let known = ui.data(|data| data.get_temp::<(f64, bool)>(id));
    match known {
        Some((then, exists)) if now - then < 1.0 => exists,
        _ => {
            let exists = path.exists();
            ui.data_mut(|data| data.insert_temp(id, (now, exists)));
            exists
        }
    }
}

/// The folder that a path starts at, if it says so: `resolved` without `written` at its end.
pub(super) fn folder_of(written: &str, resolved: &Path) -> Option<PathBuf> {
    let steps = Path::new(written).components().count();
    let is_relative = !written.is_empty() && Path::new(written).is_relative() && resolved.ends_with(written);
    let folder = resolved.ancestors().nth(steps)?;
    is_relative.then(|| folder.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_a_path_is_what_it_starts_at() {
        let folder = |written, resolved| folder_of(written, Path::new(resolved));
        assert_eq!(folder("../assets/a.obj", "scenes/../assets/a.obj"), Some("scenes".into()));
        assert_eq!(folder("a.obj", "a.obj"), Some("".into()));
        assert_eq!(folder("/data/a.obj", "/data/a.obj"), None);
        assert_eq!(folder("", "scenes"), None);
        assert_eq!(folder("b.obj", "scenes/a.obj"), None);
    }
}
