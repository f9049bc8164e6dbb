//! A scene that follows its files.
//!
//! ```text
//! files ──watch──▶ what holds something else ──┬─ text ────▶ document ──▶ world, only what differs from the last good text
//!                                              ├─ assets ──▶ FileChanged, for those who read them
//!                                              └─ shaders ─▶ pipelines and what they made
//! ```

use super::document::{Override, SceneDocument};
use super::edits::{Edits, SaveError};
use super::problem::{Problem, Problems};
use super::reconcile::{Changes, reconcile_after};
use super::watch::{Altered, FileWatch, Found, Reason, Wake, content};
use crate::failure::Failure;
use crate::gpu::{Gpu, shader};
use crate::loading::{FileChanged, FilesRead};
use crate::passes::products;
use crate::report::Report;
use crate::sources::trail::{FileState, Trail};
use crate::{mirrors, render, whole_file};
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};
use std::time::Instant;

/// A scene in a world, and the files that it came from: text with includes and component files, meshes, volumes, and with
/// `TYNDALL_SHADERS` the shaders.
///
/// [`LiveScene::poll`] brings the world up to date with the files, in one batch and by value. A text with errors changes nothing: the world
/// stays that of the last good one, and [`LiveScene::problems`] says why. What the files do not say, and what systems or tools have written
/// to entities whose text is the same, stays as it is.
///
/// ```no_run
/// use std::sync::mpsc::channel;
/// use tyndall::prelude::*;
/// use tyndall::scene::LiveScene;
///
/// let mut app = App::new();
/// app.add_plugins(TyndallPlugins);
/// let mut scene = LiveScene::open(&mut app, "scenes/showcase.ron".as_ref(), &[]);
/// let (wake, woken) = channel();
/// scene.on_change(Box::new(move || _ = wake.send(())));
/// loop {
///     app.update();
///     scene.problems(app.world()).iter().for_each(|problem| eprintln!("{problem}"));
///     woken.recv()?;
///     println!("{:?}", scene.poll(&mut app));
/// }
/// # #[allow(unreachable_code)]
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct LiveScene {
    path: PathBuf,
    /// The text of a scene that is in no file yet.
    unsaved: Option<String>,
    overrides: Vec<Override>,
    /// The last good text, which the world was made from.
    document: Arc<SceneDocument>,
    /// Whether a person is to be able to edit it.
    is_for_editing: bool,
    /// What is wrong with the text that is there now, if it cannot be shown.
    refused: Option<Vec<Problem>>,
    /// The files that were looked for when the text was read last.
    text: BTreeSet<PathBuf>,
    watch: Arc<FileWatch>,
}

/// What a poll did.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reload {
    /// No file holds anything else than before.
    Nothing,
    /// The world follows the files.
    Reloaded {
        /// What the scene's text changed in the world; nothing, for example, if a comment was edited.
        changes: Changes,
        /// Meshes, volumes and others that entities were read from, which the next update reads again.
        assets: usize,
        /// Shaders that are compiled again when they are next used, those that import what changed included.
        shaders: usize,
    },
    /// The scene's text has errors; the world stays. What else has changed takes effect.
    Refused {
        /// How many problems it has.
        problems: usize,
    },
}

/// The watch that systems tell of the files they read.
#[derive(Resource)]
pub(crate) struct AssetWatch(Weak<FileWatch>);

impl LiveScene {
    /// Reads a scene into the world of `app` and begins to watch its files. One that has errors leaves the world as it is.
    pub fn open(app: &mut App, path: &Path, overrides: &[Override]) -> Self {
        Self::open_as(app, path, None, overrides)
    }

    /// The same for a scene whose text is in no file yet, as if it stood in one at `path`. The files that it names are watched.
    pub fn open_text(app: &mut App, path: &Path, text: String, overrides: &[Override]) -> Self {
        Self::open_as(app, path, Some(text), overrides)
    }

    fn open_as(app: &mut App, path: &Path, unsaved: Option<String>, overrides: &[Override]) -> Self {
        let watch = Arc::new(FileWatch::new());
        // What an earlier scene has read is told to this one too.
        app.world_mut().remove_resource::<AssetWatch>();
        app.insert_resource(AssetWatch(Arc::downgrade(&watch)));
        let mut scene = Self {
            path: path.to_owned(),
            unsaved,
            overrides: overrides.to_vec(),
            document: Arc::default(),
            is_for_editing: false,
            refused: None,
            text: BTreeSet::new(),
            watch,
        };
        // Before it is read, so that what changes meanwhile is told of.
        let found = Found { path: path.to_owned(), state: FileState::of(path), content: None };
        scene.watch.watch(Reason::Text, vec![found]);
        scene.watch.watch(Reason::Shaders, shader_files());
        scene.read(app);
        scene
    }

    /// From here on the world has [`Edits`] of the scene, as soon as there is a version without errors. Overrides become edits that are not
    /// saved. Edits stay when files are read again; what the files say to the contrary meanwhile becomes a [`Conflict`](super::Conflict).
    pub fn allow_edits(&mut self, app: &mut App) {
        self.is_for_editing = true;
        if self.refused.is_none() {
            self.refused = self.begin_edits(app.world_mut()).err();
        }
    }

    fn begin_edits(&mut self, world: &mut World) -> Result<(), Vec<Problem>> {
        let edits = match &self.unsaved {
            Some(text) => Edits::of_text(world, &self.path, text.clone(), &self.overrides)?,
            None => Edits::open(world, &self.path, &self.overrides)?,
        };
        self.overrides.clear();
        self.document = edits.base().clone();
        world.insert_resource(edits);
        Ok(())
    }

    /// Writes the scene, with what was changed of it, into a file at `path`, and follows that from here on.
    ///
    /// # Errors
    ///
    /// If an edit cannot be written, the file cannot, or there is a file already.
    pub fn save_as(&mut self, app: &mut App, path: &Path) -> Result<(), SaveError> {
        if path.exists() {
            let source = std::io::ErrorKind::AlreadyExists.into();
            return Err(SaveError::File { path: path.to_owned(), source });
        }
        self.save_over(app, path)
    }

    /// The same, whatever there is at `path`.
    ///
    /// # Errors
    ///
    /// If an edit cannot be written, or the file cannot.
    pub fn save_over(&mut self, app: &mut App, path: &Path) -> Result<(), SaveError> {
        let world = app.world_mut();
        let failed = |source| SaveError::File { path: path.to_owned(), source };
        let text = match world.remove_resource::<Edits>() {
            Some(edits) => {
                let text = edits.text_for(world, path);
                world.insert_resource(edits);
                text?
            }
            None => self.unsaved.clone().unwrap_or_default(),
        };
        whole_file::write(path, text.as_bytes()).map_err(failed)?;
        self.path = path.to_owned();
        self.unsaved = None;
        let found = Found { path: path.to_owned(), state: FileState::of(path), content: None };
        self.watch.watch(Reason::Text, vec![found]);
        if self.is_for_editing {
            self.begin_edits(world).map_err(SaveError::Broken)?;
        }
        self.read(app);
        Ok(())
    }

    /// Whether the scene is in no file yet.
    pub fn is_untitled(&self) -> bool {
        self.unsaved.is_some()
    }

    /// Where the scene is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The last good text of the scene, which the world follows.
    pub fn document(&self) -> &SceneDocument {
        &self.document
    }

    /// Whether the text that is there now has errors, so that the world follows an earlier one.
    pub fn is_refused(&self) -> bool {
        self.refused.is_some()
    }

    /// Has `wake` called, from another thread, whenever files have changed. It should do no more than wake up who then polls.
    pub fn on_change(&self, wake: Wake) {
        self.watch.on_change(wake);
    }

    /// Brings the world up to date with the files, if any of them holds something else than before. Meshes and volumes are read by the
    /// update that follows.
    pub fn poll(&mut self, app: &mut App) -> Reload {
        let Some(Altered { files, since }) = self.watch.take() else { return Reload::Nothing };
        app.world_mut().resource_mut::<Report>().spent("watch", since);
        let shaders = follow_shaders(app.world_mut(), &files);
        let assets = tell_of_assets(app.world_mut(), &files);
        app.world_mut().resource_mut::<Failure>().forget();
        let mut changes = Changes::default();
        if !files.is_disjoint(&self.text) {
            changes = self.read(app);
            if let Some(problems) = &self.refused {
                return Reload::Refused { problems: problems.len() };
            }
        }
        Reload::Reloaded { changes, assets, shaders }
    }

    /// Takes what the text's files say now as known: they were written by whoever calls this.
    pub(crate) fn was_saved(&mut self, app: &mut App) {
        self.read(app);
    }

    /// Reads the text again, and makes the world what it says if it is good.
    fn read(&mut self, app: &mut App) -> Changes {
        let started = Instant::now();
        let world = app.world_mut();
        let registry = world.resource::<AppTypeRegistry>().clone();
        let document = {
            let last = Some(self.document.as_ref());
            let overrides = self.overrides_in_force(world);
            match &self.unsaved {
                Some(text) => SceneDocument::of_text(&self.path, text.clone(), &registry.read(), overrides),
                None => SceneDocument::load_after(&self.path, &registry.read(), overrides, last),
            }
        };
        world.resource_mut::<Report>().spent("parse", started);
        self.watch_text(&document);
        if document.has_errors() {
            self.refused = Some(document.problems);
            return Changes::default();
        }
        let started = Instant::now();
        let shown = self.show(world, Arc::new(document));
        world.resource_mut::<Report>().spent("reconcile", started);
        match shown {
            Ok(changes) => {
                self.refused = None;
                changes
            }
            Err(problems) => {
                self.refused = Some(problems);
                Changes::default()
            }
        }
    }

    /// Those that are not edits.
    fn overrides_in_force(&self, world: &World) -> &[Override] {
        if world.contains_resource::<Edits>() { &[] } else { &self.overrides }
    }

    /// Makes the world what a document without errors says, with what a person has edited.
    fn show(&mut self, world: &mut World, document: Arc<SceneDocument>) -> Result<Changes, Vec<Problem>> {
        // Before the first good text the world is whatever it is.
        let last = Some(self.document.as_ref()).filter(|last| !last.trail().is_empty());
        let changes = match world.contains_resource::<Edits>() {
            true => world.resource_scope(|world, mut edits: Mut<Edits>| {
                let changes = edits.take_in(world, document.clone())?;
                world.insert_resource(Problems(edits.document().problems.clone()));
                Ok::<_, Vec<Problem>>(changes)
            })?,
            false => {
                let changes = reconcile_after(world, &document, last);
                world.insert_resource(Problems(document.problems.clone()));
                changes
            }
        };
        self.document = document;
        if self.is_for_editing && !world.contains_resource::<Edits>() {
            self.begin_edits(world)?;
        }
        Ok(changes)
    }

    fn watch_text(&mut self, document: &SceneDocument) {
        self.text = document.trail().keys().cloned().collect();
        let content_of = |path: &Path| {
            // With overrides in force it is not what is in the file.
            let file = document.source(path).filter(|_| self.overrides.is_empty());
            file.map(|file| content(file.text().as_bytes()))
        };
        let found = |(path, state): (&PathBuf, &FileState)| Found {
            path: path.clone(),
            state: *state,
            content: content_of(path),
        };
        self.watch.watch(Reason::Text, document.trail().iter().map(found).collect());
    }

    /// All that is wrong with the scene: with its text as it is now, with the files that its entities name, with shaders, and with watching.
    pub fn problems(&self, world: &World) -> Vec<Problem> {
        let mut problems = self.refused.clone().unwrap_or_default();
        problems.extend(render::problems(world, &self.document));
        let shaders = world.get_resource::<Gpu>().map(Gpu::shader_failures).unwrap_or_default();
        problems.extend(
            shaders.into_iter().map(|failure| {
                Problem::error(failure).help("until it compiles, the shader is used as it was")
            }),
        );
        problems.extend(self.watch.trouble().into_iter().map(|(folder, reason)| {
            let what =
                if folder.as_os_str().is_empty() { "files".into() } else { folder.display().to_string() };
            Problem::note(format!("changes of {what} are seen only once a second: {reason}"))
                .help("on Linux `sysctl fs.inotify` shows how many folders can be watched")
        }));
        problems
    }
}

fn shader_files() -> Vec<Found> {
    let folder = shader::folder();
    let paths = folder.iter().flat_map(|folder| shader::SOURCES.iter().map(|(_, path, _)| folder.join(path)));
    paths.map(|path| Found { state: FileState::of(&path), path, content: None }).collect()
}

/// Has the shaders compiled again that are or import one of these files, and answers how many they are.
fn follow_shaders(world: &mut World, files: &BTreeSet<PathBuf>) -> usize {
    let affected = shader::affected(files.iter().map(PathBuf::as_path), &mirrors::generated_modules());
    if !affected.is_empty()
        && let Some(gpu) = world.get_resource::<Gpu>()
    {
        gpu.shaders_changed();
        products::forget(world, &affected);
    }
    affected.len()
}

/// Tells those who read files, and answers how many of these files any entity was read from.
fn tell_of_assets(world: &mut World, files: &BTreeSet<PathBuf>) -> usize {
    world.write_message_batch(files.iter().cloned().map(FileChanged));
    let Some(mut query) = world.try_query::<&FilesRead>() else { return 0 };
    let read: HashSet<&PathBuf> = query
        .iter(world)
        .flat_map(FilesRead::all)
        .map(|(path, _)| path)
        .filter(|path| files.contains(*path))
        .collect();
    read.len()
}

/// Has those files watched that entities were read from.
pub(crate) fn watch_assets(
    watch: Res<AssetWatch>,
    changed: Query<(), Changed<FilesRead>>,
    mut removed: RemovedComponents<FilesRead>,
    all: Query<&FilesRead>,
) {
    if changed.is_empty() && removed.read().count() == 0 && !watch.is_added() {
        return;
    }
    let Some(watch) = watch.0.upgrade() else { return };
    let mut files = Trail::new();
    for (path, state) in all.iter().flat_map(FilesRead::all) {
        let first = *files.entry(path.clone()).or_insert(*state);
        if first != *state {
            // Two entities have read different things: whatever is there now, one of them is to read it again.
            files.insert(path.clone(), FileState::Missing);
        }
    }
    let found = |(path, state)| Found { path, state, content: None };
    watch.watch(Reason::Assets, files.into_iter().map(found).collect());
}
