//! A scene in a folder of its own that is followed while its files change.

#![allow(dead_code, reason = "each test binary uses its own part")]

use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use tyndall::prelude::*;
use tyndall::scene::{LiveScene, Problem, Reload, SceneEntities};

/// Longer than any change takes to be noticed. Nothing passes because time has run out: only failures take this long.
pub const PATIENCE: Duration = Duration::from_secs(20);

pub struct Live {
    pub app: App,
    pub scene: LiveScene,
    pub folder: tempfile::TempDir,
    woken: Receiver<()>,
}

impl Live {
    /// A folder with these files, of which `scene.ron` is opened.
    pub fn open(files: &[(&str, &str)]) -> Self {
        Self::open_in(App::new(), files, "scene.ron")
    }

    pub fn open_in(mut app: App, files: &[(&str, &str)], scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            write_in(&folder, name, text.as_bytes());
        }
        app.add_plugins(TyndallPlugins);
        let scene = LiveScene::open(&mut app, &folder.path().join(scene), &[]);
        app.update();
        let mut live = Self { app, scene, folder, woken: channel().1 };
        live.listen();
        live
    }

    /// Has the scene wake this thread.
    pub fn listen(&mut self) {
        let (wake, woken) = channel();
        // Whoever listens may be gone already.
        self.scene.on_change(Box::new(move || _ = wake.send(())));
        self.woken = woken;
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        write_in(&self.folder, name, text.as_bytes());
    }

    /// Sleeps until woken, then follows.
    pub fn next(&mut self) -> Reload {
        loop {
            self.woken.recv_timeout(PATIENCE).expect("a change is told of");
            match self.scene.poll(&mut self.app) {
                // What two calls told of was taken by one poll.
                Reload::Nothing => {}
                reload => {
                    self.app.update();
                    return reload;
                }
            }
        }
    }

    /// Follows until the world is as it should be.
    pub fn until(&mut self, what: &str, mut is_so: impl FnMut(&mut Self) -> bool) -> Vec<Reload> {
        let started = Instant::now();
        let mut reloads = Vec::new();
        while !is_so(self) {
            assert!(started.elapsed() < PATIENCE, "{what}: {reloads:#?} {:#?}", self.problems());
            reloads.push(self.next());
        }
        reloads
    }

    /// Follows until a change of `mark.ron`, made after everything else, has arrived: then all that was noticed before has too.
    pub fn until_marked(&mut self) -> Vec<Reload> {
        let next = self.get::<Transform>("mark").expect("`mark.ron` is included").translation.x + 1.0;
        self.write("mark.ron", &mark(next));
        self.until("the mark", |live| {
            live.get::<Transform>("mark").is_some_and(|at| at.translation.x == next)
        })
    }

    /// Every component of the scene's entities that scenes can write, with the tick at which it last changed.
    pub fn ticks(&self) -> BTreeMap<String, u32> {
        let world = self.app.world();
        let registry = world.resource::<AppTypeRegistry>().read();
        let mut ticks = BTreeMap::new();
        for (name, entity) in &world.resource::<SceneEntities>().0 {
            let entity = world.entity(*entity);
            for registration in registry.iter().filter(|known| known.data::<ReflectComponent>().is_some()) {
                let id = world.components().get_id(registration.type_id());
                if let Some(ticks_of) = id.and_then(|id| entity.get_change_ticks_by_id(id)) {
                    let component = registration.type_info().type_path_table().short_path();
                    ticks.insert(format!("{name}.{component}"), ticks_of.changed.get());
                }
            }
        }
        ticks
    }

    /// The components that were written, added or removed since, but for the mark's.
    pub fn changed_since(&self, before: &BTreeMap<String, u32>) -> Vec<String> {
        let now = self.ticks();
        let all: BTreeSet<&String> = before.keys().chain(now.keys()).collect();
        let changed = all.into_iter().filter(|name| before.get(*name) != now.get(*name));
        changed.filter(|name| !name.starts_with("mark.")).cloned().collect()
    }

    pub fn problems(&self) -> Vec<Problem> {
        self.scene.problems(self.app.world())
    }

    pub fn messages(&self) -> Vec<String> {
        self.problems().iter().map(Problem::to_string).collect()
    }

    pub fn get<T: Component + Clone>(&self, name: &str) -> Option<T> {
        let entity = self.app.world().resource::<SceneEntities>().0.get(name)?;
        self.app.world().get::<T>(*entity).cloned()
    }

    pub fn has(&self, name: &str) -> bool {
        self.app.world().resource::<SceneEntities>().0.contains_key(name)
    }

    pub fn radius(&self) -> f32 {
        match self.get("ball") {
            Some(Mesh::Sphere { radius, .. }) => radius,
            other => panic!("no sphere: {other:?}"),
        }
    }
}

/// The text of `mark.ron`.
pub fn mark(x: f32) -> String {
    format!("(entities: {{ \"mark\": ( Transform: (translation: ({x:?}, 0.0, 0.0)) ) }})")
}

/// A scene of these entities, and the mark.
pub fn scene(entities: &str) -> String {
    format!("(include: [\"mark.ron\"], entities: {{\n{entities}\n}})")
}

/// One with a ball of this radius.
pub fn ball(radius: f32) -> String {
    scene(&format!("\"ball\": ( Mesh: Sphere(radius: {radius:?}, subdivisions: 0) ),"))
}

fn write_in(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}
