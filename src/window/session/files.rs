//! The files of a session: what is opened in it, and where its scene is written.

use super::Session;
use crate::TyndallPlugins;
use crate::loading::FilesRead;
use crate::render::{all_problems, load_text};
use crate::scene::{
    Edits, LiveScene, Orientation, Problem, SceneDocument, SceneEntities, Severity, is_data, scene_of_files,
    untitled_for,
};
use crate::ui::{self, Chooser, Command, Leaving, Level, OpenPanels, Recent};
use crate::view::{FreeCamera, Picture};
use crate::whole_file::folder_of;
use crate::window::edits;
use crate::window::stale::Drawn;
use bevy_app::App;
use bevy_ecs::reflect::AppTypeRegistry;
use glam::UVec2;
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

impl Session {
    /// Shows other files instead: one scene as it is; meshes, volumes and folders of slices, or several files, as a scene that is in no
    /// file yet. Where edits would be lost, the panels ask first what is to become of them. What cannot be opened is told, and what is shown
    /// stays.
    pub fn open(&mut self, files: &[PathBuf]) {
        if !files.is_empty() && self.may_leave(Leaving::ToOpen(files.to_vec())) {
            self.open_now(files);
        }
    }

    /// Does what panels could ask for, and says whether the window is to be closed.
    pub fn act(&mut self, command: Command) -> bool {
        if command.concerns_files() {
            return self.obey_files(command);
        }
        self.obey(vec![command], self.room.max(UVec2::ONE));
        false
    }

    /// Opens what was dropped on the window, and says whether that was anything.
    pub(super) fn take_dropped(&mut self, input: &egui::RawInput) -> bool {
        let files: Vec<PathBuf> = input.dropped_files.iter().map(|file| file.path().to_owned()).collect();
        self.open(&files);
        !files.is_empty()
    }

    /// Does what concerns files, and says whether the window is to be closed.
    pub(super) fn obey_files(&mut self, command: Command) -> bool {
        match command {
            Command::Open(files) => self.open(&files),
            Command::DiscardAndOpen(files) => {
                edits::forget_taken(self.app.world_mut());
                self.open_now(&files);
            }
            Command::AskOpen => {
                let folder = match self.scene.is_untitled() {
                    true => PathBuf::new(),
                    false => self.scene.path().parent().map(Path::to_owned).unwrap_or_default(),
                };
                self.app.insert_resource(Chooser::to_open(&folder));
            }
            Command::AskSaveAs => self.ask_where(Leaving::No),
            Command::SaveAs(path) => return self.save_as(&path),
            Command::Save => return self.save(Leaving::No),
            Command::SaveAndQuit => return self.save(Leaving::ToClose),
            Command::SaveAndOpen(files) => return self.save(Leaving::ToOpen(files)),
            Command::Quit => return self.may_quit(),
            Command::Discard => {
                edits::forget_taken(self.app.world_mut());
                return true;
            }
            _ => {}
        }
        false
    }

    /// Whether nothing would be lost; else a person is asked.
    pub(super) fn may_leave(&mut self, to: Leaving) -> bool {
        let is_unsaved = self.is_unsaved();
        self.app.insert_resource(if is_unsaved { to } else { Leaving::No });
        !is_unsaved
    }

    /// Has the change of files told of to whoever wanted to know, whichever scene is shown.
    pub(super) fn follow_changes(&self) {
        let Some(wake) = self.wake.clone() else { return };
        self.scene.on_change(Box::new(move || wake.lock().unwrap_or_else(PoisonError::into_inner)()));
    }

    /// Tells everybody where the scene is.
    pub(super) fn follow_scene(&mut self) {
        self.shown.is_untitled = self.scene.is_untitled();
        let path = self.scene.path().to_owned();
        let world = self.app.world_mut();
        world.insert_resource(ui::SceneFolder(path.parent().unwrap_or("".as_ref()).to_owned()));
        if !self.shown.is_untitled {
            world.get_resource_or_init::<Recent>().add(&path);
        }
    }

    fn open_now(&mut self, files: &[PathBuf]) {
        let (path, text) = match self.read(files) {
            Ok(read) => read,
            Err(problem) => {
                let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
                let place = problem.place.as_ref().map_or(String::new(), |place| format!("{place}: "));
                let what = format!("cannot open {}: {place}{}", names.join(", "), problem.message);
                self.refuse(&what, problem.help.as_deref().unwrap_or("what is shown stays as it is"));
                return;
            }
        };
        // They are of the scene that goes.
        self.app.world_mut().remove_resource::<Edits>();
        self.scene = match text {
            Some(text) => LiveScene::open_text(&mut self.app, &path, text, &[]),
            None => LiveScene::open(&mut self.app, &path, &[]),
        };
        self.scene.allow_edits(&mut self.app);
        self.follow_changes();
        let world = self.app.world_mut();
        world.resource_mut::<crate::failure::Failure>().forget();
        world.insert_resource(ui::Selection::default());
        let picture = Picture { camera: None, ..world.resource::<Picture>().clone() };
        world.insert_resource(picture);
        world.insert_resource(FreeCamera(None));
        world.remove_resource::<Chooser>();
        for file in files {
            world.get_resource_or_init::<Recent>().add(file);
        }
        self.orbit = None;
        self.shown.is_free = false;
        self.shown.notice = None;
        self.then = Leaving::No;
        self.follow_scene();
        self.told.clear();
        self.has_reloaded = true;
        self.drawn = Drawn::default();
        for file in files {
            self.log.tell(Level::Info, format!("opened {}", file.display()));
        }
        self.tell_problems();
    }

    /// The path of a scene, and its text if it is in no file; what is wrong where it cannot be shown.
    #[allow(clippy::result_large_err, reason = "a problem is met once, when a person opens a file")]
    fn read(&self, files: &[PathBuf]) -> Result<(PathBuf, Option<String>), Problem> {
        let registry = self.app.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        if let [scene] = files
            && !is_data(scene)
        {
            first_error(SceneDocument::load(scene, &registry, &[]).problems)?;
            return Ok((scene.clone(), None));
        }
        let untitled = untitled_for(files);
        let made = |files: &[PathBuf]| {
            scene_of_files(files, &folder_of(&untitled), &Orientation::default())
                .map_err(|error| Problem::error(error.to_string()))
        };
        let text = made(files)?;
        first_error(SceneDocument::of_text(&untitled, text.clone(), &registry, &[]).problems)?;
        // Data are read once to find out whether they can be: afterwards nothing that was shown would be left.
        let data: Vec<PathBuf> = files.iter().filter(|file| is_data(file)).cloned().collect();
        let mut trial = App::new();
        trial.add_plugins(TyndallPlugins);
        let document = load_text(&mut trial, &untitled, made(&data)?, &[]);
        if !data.is_empty() {
            first_error(all_problems(&mut trial, &document))?;
        }
        Ok((untitled, Some(text)))
    }

    /// Tells, in two lines, that something was not done and what to do about it.
    fn refuse(&mut self, what: &str, help: &str) {
        log::error!("{what}; {help}");
        self.log.tell(Level::Error, what);
        self.log.tell(Level::Error, format!("  {help}"));
        self.shown.notice = Some(format!("{what}\n{help}"));
        let world = self.app.world_mut();
        if let Some(mut chooser) = world.get_resource_mut::<Chooser>() {
            chooser.complaint = Some(format!("{what}\n{help}"));
        }
        // It is not to be missed.
        world.get_resource_or_init::<OpenPanels>().log = true;
    }

    /// Saves the scene where it is, or asks where that is to be, and goes on; says whether the window is to be closed.
    fn save(&mut self, then: Leaving) -> bool {
        if self.scene.is_untitled() {
            self.ask_where(then);
            return false;
        }
        let is_saved = edits::save(self.app.world_mut());
        self.scene.was_saved(&mut self.app);
        is_saved && self.go_on(then)
    }

    /// Does what waited for the scene to be saved, and says whether the window is to be closed.
    fn go_on(&mut self, then: Leaving) -> bool {
        match then {
            Leaving::No => {}
            Leaving::ToClose => return true,
            Leaving::ToOpen(files) => self.open_now(&files),
        }
        false
    }

    fn ask_where(&mut self, then: Leaving) {
        let path = match self.scene.is_untitled() {
            true => self.name(),
            false => self.scene.path().to_owned(),
        };
        self.app.insert_resource(Chooser::to_save(&path));
        self.then = then;
        self.replaceable = None;
    }

    /// A name for the scene: that of its first entity that was read from a file, which is called as the file is.
    fn name(&self) -> PathBuf {
        let world = self.app.world();
        let entities = world.get_resource::<SceneEntities>();
        let is_read = |name: &str| {
            let entity = entities.and_then(|entities| entities.0.get(name));
            entity.is_some_and(|entity| world.get::<FilesRead>(*entity).is_some())
        };
        let first = self.scene.document().entities.iter().find(|written| is_read(&written.name));
        let name = first.map_or("scene", |first| &first.name);
        format!("{}.ron", name.replace(std::path::is_separator, "_")).into()
    }

    /// Writes the scene into another file, and goes on with what waited for that; says whether the window is to be closed.
    fn save_as(&mut self, path: &Path) -> bool {
        let path = if path.extension().is_none() { path.with_extension("ron") } else { path.to_owned() };
        if !self.scene.is_untitled() && path == self.scene.path() {
            self.app.world_mut().remove_resource::<Chooser>();
            let then = std::mem::take(&mut self.then);
            return self.save(then);
        }
        let cannot = |why: &str| format!("cannot write {}: {why}", path.display());
        if path.exists() && (path.is_dir() || is_data(&path)) {
            self.refuse(&cannot("it is a folder, a mesh or a volume"), "choose another name");
            return false;
        }
        let once_more = self.replaceable.take().is_some_and(|replaceable| replaceable == path);
        if path.exists() && !once_more {
            self.refuse(
                &cannot("there is a file already"),
                "choose another name, or ask for it once more to replace the file",
            );
            self.replaceable = Some(path);
            return false;
        }
        if let Err(error) = self.scene.save_over(&mut self.app, &path) {
            self.refuse(&error.to_string(), "the scene is kept as it is shown");
            return false;
        }
        self.log.tell(Level::Info, format!("saved {}", path.display()));
        self.shown.notice = None;
        self.app.world_mut().remove_resource::<Chooser>();
        self.follow_scene();
        self.drawn = Drawn::default();
        self.tell_problems();
        let then = std::mem::take(&mut self.then);
        self.go_on(then)
    }
}

#[allow(clippy::result_large_err, reason = "a problem is met once, when a person opens a file")]
fn first_error(problems: Vec<Problem>) -> Result<(), Problem> {
    match problems.into_iter().find(|problem| problem.severity == Severity::Error) {
        Some(problem) => Err(problem),
        None => Ok(()),
    }
}
