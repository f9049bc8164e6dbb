//! What passes could not do.
//!
//! A pass that fails marks the entity that it worked for. The passes of that entity are then left alone, and the picture stays as it was
//! last, until something of the scene changes; then all is tried again.

use crate::changes::Seen;
use crate::gpu::GpuError;
use crate::passes::{raycast::RayCaster, surface::Surface};
use crate::scene::{EntityProblems, Problem};
use bevy_ecs::prelude::*;
use std::collections::BTreeMap;

/// The failures of passes.
#[derive(Resource, Debug, Default)]
pub(crate) struct Failure {
    /// The first of this update.
    first: Option<GpuError>,
    /// The entities that passes failed for, with the pass and what is told of it.
    standing: BTreeMap<Entity, (&'static str, Problem)>,
    /// Those that are marked, by the pass.
    marked: BTreeMap<Entity, &'static str>,
    /// The scene as it was when the last of them failed.
    seen: Seen,
    /// Whether one did in this update.
    is_new: bool,
    /// Whether there is a picture to be kept.
    has_picture: bool,
}

impl Failure {
    /// Keeps an error, unless an earlier one is there: what follows is often only its consequence.
    pub fn keep(&mut self, result: Result<(), GpuError>) {
        if let (None, Err(error)) = (&self.first, result) {
            self.first = Some(error);
        }
    }

    /// Keeps why a pass failed for an entity, and with what component of it that has to do.
    pub fn on(&mut self, entity: Entity, pass: &'static str, component: &'static str, error: GpuError) {
        let told = || {
            let problem = Problem::error(format!("the pass {pass} failed: {error}")).on(entity, component);
            (
                pass,
                problem.help("the last picture stays; it is tried again when something of the scene changes"),
            )
        };
        self.standing.entry(entity).or_insert_with(told);
        self.is_new = true;
        self.keep(Err(error));
    }

    /// Whether a pass failed for an entity, of which nothing is to be made until something changes.
    pub fn stands_on(&self, entity: Entity) -> bool {
        self.standing.contains_key(&entity)
    }

    /// Whether the picture is to be left as it is.
    pub fn keeps_picture(&self) -> bool {
        self.has_picture && !self.standing.is_empty()
    }

    /// The failure of this update, which counts as told then.
    pub fn take(&mut self) -> Option<GpuError> {
        self.first.take()
    }

    /// Has everything be tried again: for changes that leave no mark on components, of files and shaders.
    pub fn forget(&mut self) {
        self.standing.clear();
    }
}

/// Has what failed be tried again once the scene is another.
pub(crate) fn retry(world: &mut World) {
    world.resource_scope(|world, mut failure: Mut<Failure>| {
        if !failure.standing.is_empty() && failure.seen.has_changed(world) {
            failure.forget();
        }
    });
}

/// Marks the entities that passes failed for, and no others.
pub(crate) fn mark(world: &mut World) {
    world.resource_scope(|world, mut failure: Mut<Failure>| {
        let Failure { standing, marked, seen, is_new, has_picture, .. } = &mut *failure;
        *has_picture = world.get_resource::<RayCaster>().is_some_and(|caster| caster.radiance().is_some())
            || world.get_resource::<Surface>().is_some_and(|surface| surface.colour().is_some());
        let now: BTreeMap<Entity, &'static str> =
            standing.iter().map(|(entity, (pass, _))| (*entity, *pass)).collect();
        let mut commands = world.commands();
        for (entity, pass) in marked.iter().filter(|(entity, pass)| now.get(entity) != Some(pass)) {
            EntityProblems::set(&mut commands, *entity, pass, Vec::new());
        }
        for (entity, (pass, problem)) in standing.iter().filter(|(entity, _)| !marked.contains_key(*entity)) {
            EntityProblems::set(&mut commands, *entity, pass, vec![problem.clone()]);
        }
        world.flush();
        *marked = now;
        if std::mem::take(is_new) {
            seen.take(world);
        }
    });
}
