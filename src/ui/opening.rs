//! The questions which file to open, and which one to write.

use super::Command;
use crate::sources::{Kind, recognise, slices};
use bevy_ecs::prelude::*;
use egui::{Id, Key, Modal, ScrollArea, TextEdit, Ui};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The files that were opened last, the newest first.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recent(pub Vec<PathBuf>);

/// Files that are remembered.
const MOST_RECENT: usize = 10;

impl Recent {
    /// Makes a file the newest. One whose name is no text cannot be remembered.
    pub fn add(&mut self, file: &Path) {
        let file = file.canonicalize().unwrap_or_else(|_| file.to_owned());
        if file.to_str().is_none() || !file.exists() {
            return;
        }
        self.0.retain(|other| *other != file && other.exists());
        self.0.insert(0, file);
        self.0.truncate(MOST_RECENT);
    }
}

/// A file that is being chosen.
#[derive(Resource, Clone, Debug)]
pub(crate) struct Chooser {
    is_to_save: bool,
    folder: PathBuf,
    /// What is typed: a path, as seen from the folder.
    typed: String,
    entries: Vec<Entry>,
    is_new: bool,
    /// Why the last choice was none.
    pub complaint: Option<String>,
}

/// A file of the folder, and what it is once it has been seen.
#[derive(Clone, Debug)]
struct Entry {
    name: String,
    is_folder: bool,
    kind: Option<&'static str>,
}

/// Entries that are listed of a folder.
const MOST_ENTRIES: usize = 5000;

/// Files of a folder that are looked at to find out whether they are DICOM slices.
const LOOKED_AT: usize = 4;

const FOLDER: &str = "folder";
const SLICES: &str = "DICOM folder";
const PICTURES: &str = "folder of pictures";

impl Chooser {
    /// Asks which file to open, with those of a folder to choose from.
    pub fn to_open(folder: &Path) -> Self {
        Self::new(folder, String::new(), false)
    }

    /// Asks where to write a scene, with a path to begin with.
    pub fn to_save(path: &Path) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Self::new(path.parent().unwrap_or("".as_ref()), name, true)
    }

    fn new(folder: &Path, typed: String, is_to_save: bool) -> Self {
        let mut chooser = Self {
            is_to_save,
            folder: PathBuf::new(),
            typed,
            entries: Vec::new(),
            is_new: true,
            complaint: None,
        };
        chooser.enter(if folder.as_os_str().is_empty() { ".".as_ref() } else { folder });
        chooser
    }

    /// Lists another folder: folders first, then files, by name.
    fn enter(&mut self, folder: &Path) {
        self.folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        self.complaint = None;
        let found = match self.folder.read_dir() {
            Ok(found) => found,
            Err(error) => {
                self.entries.clear();
                self.complaint = Some(format!("{}: {error}", self.folder.display()));
                return;
            }
        };
        let entry = |found: std::fs::DirEntry| {
            let name = found.file_name().into_string().ok().filter(|name| !name.starts_with('.'))?;
            Some(Entry { name, is_folder: found.path().is_dir(), kind: None })
        };
        self.entries = found.flatten().filter_map(entry).take(MOST_ENTRIES).collect();
        self.entries.sort_by_cached_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
    }

    /// What is asked for when the choice is made; a folder that is no data is listed instead.
    fn choose(&mut self) -> Option<Command> {
        if self.typed.trim().is_empty() {
            return None;
        }
        let path = self.folder.join(self.typed.trim());
        match (self.is_to_save, path.is_dir()) {
            (_, true) if self.is_to_save || kind_of(&path, true) == FOLDER => {
                self.typed.clear();
                self.enter(&path);
                None
            }
            (true, _) => Some(Command::SaveAs(path)),
            (false, _) => Some(Command::Open(vec![path])),
        }
    }
}

/// What an entry is, in a word or two.
fn kind_of(path: &Path, is_folder: bool) -> &'static str {
    if is_folder {
        let files = path.read_dir().into_iter().flatten().flatten().map(|entry| entry.path());
        let mut files = files.filter(|path| path.is_file()).take(LOOKED_AT);
        return match () {
            () if files.any(|file| is_slice(&file)) => SLICES,
            () if slices::is_stack(path) => PICTURES,
            () => FOLDER,
        };
    }
    match recognise(path) {
        Some(Kind::Mesh) => "mesh",
        Some(Kind::Volume { .. }) => "volume",
        None if path.extension().is_some_and(|ending| ending == "ron") => "scene",
        None => "",
    }
}

fn is_slice(path: &Path) -> bool {
    let mut head = [0; 132];
    File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head.ends_with(b"DICM")
}

pub(super) fn show(ui: &Ui, world: &mut World, commands: &mut Vec<Command>) {
    let Some(mut chooser) = world.remove_resource::<Chooser>() else { return };
    let recent = world.get_resource_or_init::<Recent>().clone();
    let modal = Modal::new(Id::unique("chooser")).show(ui.ctx(), |ui| ask(ui, &mut chooser, &recent));
    let is_over = modal.should_close();
    match modal.inner {
        Answer::Cancel => {}
        Answer::Wait if is_over => {}
        Answer::Wait => world.insert_resource(chooser),
        Answer::Chosen(command) => {
            commands.push(command);
            // Closed by whoever does it, when it is done.
            world.insert_resource(chooser);
        }
    }
}

enum Answer {
    Wait,
    Cancel,
    Chosen(Command),
}

fn ask(ui: &mut Ui, chooser: &mut Chooser, recent: &Recent) -> Answer {
    ui.set_width(460.0);
    let verb = if chooser.is_to_save { "Save" } else { "Open" };
    ui.heading(if chooser.is_to_save { "Save the scene as" } else { "Open" });
    ui.horizontal(|ui| {
        if ui.button("Up").on_hover_text("List the folder around this one").clicked()
            && let Some(above) = chooser.folder.parent().map(Path::to_owned)
        {
            chooser.enter(&above);
        }
        ui.add(egui::Label::new(chooser.folder.display().to_string()).truncate());
    });
    let field = ui.add(TextEdit::singleline(&mut chooser.typed).desired_width(f32::INFINITY));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "path"));
    if std::mem::take(&mut chooser.is_new) {
        field.request_focus();
    }
    let mut is_chosen = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    is_chosen |= list(ui, chooser);
    let mut opened = None;
    if !chooser.is_to_save {
        opened = list_recent(ui, recent);
    }
    for line in chooser.complaint.iter().flat_map(|complaint| complaint.lines()) {
        ui.colored_label(ui.visuals().error_fg_color, line);
    }
    let mut is_cancelled = false;
    ui.horizontal(|ui| {
        is_chosen |= ui.button(verb).clicked();
        is_cancelled = ui.button("Cancel").clicked();
    });
    if is_cancelled {
        return Answer::Cancel;
    }
    if is_chosen {
        opened = chooser.choose();
    }
    opened.map_or(Answer::Wait, Answer::Chosen)
}

/// Lists the folder, and says whether an entry was chosen by a double click.
fn list(ui: &mut Ui, chooser: &mut Chooser) -> bool {
    let (mut entered, mut is_chosen) = (None, false);
    let Chooser { entries, folder, typed, .. } = chooser;
    let height = ui.spacing().interact_size.y;
    ScrollArea::vertical().id_salt("entries").max_height(220.0).auto_shrink([false, true]).show_rows(
        ui,
        height,
        entries.len(),
        |ui, rows| {
            for entry in entries.get_mut(rows).unwrap_or_default() {
                let path = folder.join(&entry.name);
                let kind = *entry.kind.get_or_insert_with(|| kind_of(&path, entry.is_folder));
                ui.horizontal(|ui| {
                    let row = ui.selectable_label(*typed == entry.name, &entry.name);
                    ui.weak(kind);
                    if row.clicked() && kind == FOLDER {
                        entered = Some(path.clone());
                    } else if row.clicked() {
                        typed.clone_from(&entry.name);
                    }
                    is_chosen |= row.double_clicked() && kind != FOLDER;
                });
            }
        },
    );
    if let Some(folder) = entered {
        chooser.enter(&folder);
    }
    is_chosen
}

fn list_recent(ui: &mut Ui, recent: &Recent) -> Option<Command> {
    let there: Vec<&PathBuf> = recent.0.iter().filter(|file| file.exists()).collect();
    if there.is_empty() {
        return None;
    }
    ui.separator();
    ui.weak("Opened last");
    let mut opened = None;
    for file in there {
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy();
        if ui.link(name).on_hover_text(file.display().to_string()).clicked() {
            opened = Some(Command::Open(vec![file.clone()]));
        }
    }
    opened
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn the_newest_ten_files_that_are_there_are_remembered() {
        let folder = tempfile::tempdir().unwrap();
        let file = |number: u32| folder.path().canonicalize().unwrap().join(format!("{number}.ron"));
        let mut recent = Recent::default();
        for number in 0..12 {
            std::fs::write(file(number), "()").unwrap();
            recent.add(&file(number));
        }
        assert_eq!(recent.0, (2..12).rev().map(file).collect::<Vec<_>>());
        std::fs::remove_file(file(5)).unwrap();
        recent.add(&file(3));
        recent.add(&file(99));
        assert_eq!(recent.0, [3, 11, 10, 9, 8, 7, 6, 4, 2].map(file));
    }

    #[test]
    fn folders_come_first_and_what_files_are_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("zoo")).unwrap();
        std::fs::create_dir(at("pages")).unwrap();
        for name in ["pages/1.png", "pages/2.png"] {
            std::fs::write(at(name), "").unwrap();
        }
        std::fs::create_dir(at("slices")).unwrap();
        std::fs::write(at("slices/1"), [&[0; 128][..], b"DICM\x02"].concat()).unwrap();
        std::fs::write(at("a.ron"), "()").unwrap();
        std::fs::write(at("B.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let mut chooser = Chooser::to_open(folder.path());
        let kinds: Vec<_> = chooser
            .entries
            .iter()
            .map(|entry| (entry.name.as_str(), kind_of(&at(&entry.name), entry.is_folder)))
            .collect();
        let expected =
            [("pages", PICTURES), ("slices", SLICES), ("zoo", FOLDER), ("a.ron", "scene"), ("B.obj", "mesh")];
        assert_eq!(kinds, expected);
        chooser.typed = "zoo".into();
        assert_eq!(chooser.choose(), None);
        assert_eq!(chooser.folder, at("zoo").canonicalize().unwrap());
        chooser.typed = "../slices".into();
        assert!(matches!(chooser.choose(), Some(Command::Open(files)) if files[0].ends_with("../slices")));
    }
}
