//! When a session draws its picture, and how.

use super::Session;
use crate::Refinement;
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, PassTimer};
use crate::passes::scattered_radiosity::refined;
use crate::report::Report;
use crate::ui::{LastReload, Level, OpenPanels, Totals};
use crate::view::{Coarseness, Drawing, Picture};
use crate::window::screenshot;
use bevy_ecs::prelude::*;
use glam::UVec2;
use std::time::{Duration, Instant};

/// How long nothing must change before what moved is drawn in full.
const SETTLE: Duration = Duration::from_millis(200);

/// How coarsely the light in translucent meshes is found at first, where it is to be found anew.
const COARSE_LIGHT: f32 = 0.35;

/// Sets of samples to which translucent meshes are refined while nothing changes.
const SETS: u32 = 16;

impl Session {
    /// Draws what is due, and says how long until something will be.
    ///
    /// What changes is drawn coarsely first, so that it is seen at once, and in full when nothing has changed for a while and no button is held
    /// down. Then the light that leaves translucent meshes is refined.
    pub(super) fn draw_if_due(&mut self, room: UVec2) -> Option<Duration> {
        let is_held = self.context.input(|input| input.pointer.any_down());
        let has_changed = self.drawn.is_stale(self.app.world()) || self.room != room;
        self.room = room;
        self.shown.room = room.to_array();
        let goes_on = self.shown.is_coarse && (is_held || Instant::now() < self.settles);
        let is_coarse = (has_changed || goes_on) && self.wanted.is_empty() && !self.pace.is_full();
        if has_changed || is_coarse != self.shown.is_coarse {
            self.ask(is_coarse);
            self.draw(is_coarse);
            self.is_stuck = false;
        } else if !is_coarse && self.has_to_refine() {
            self.refine();
        }
        for kind in std::mem::take(&mut self.wanted) {
            screenshot::take(self.app.world(), &self.screenshots, self.scene.path(), kind, &self.log);
        }
        match is_coarse {
            // The hand lets go sometime.
            true if is_held => None,
            true => Some(self.settles.saturating_duration_since(Instant::now())),
            false => self.has_to_refine().then_some(Duration::ZERO),
        }
    }

    /// Sets how the picture is to be drawn.
    fn ask(&mut self, is_coarse: bool) {
        let (size, coarseness) = match is_coarse {
            true => (self.pace.size(self.room), Coarseness { step: self.pace.step(), light: COARSE_LIGHT }),
            false => (self.room, Coarseness::default()),
        };
        let world = self.app.world_mut();
        let picture = Picture { size, ..world.resource::<Picture>().clone() };
        world.resource_mut::<Picture>().set_if_neq(picture);
        world.resource_mut::<Coarseness>().set_if_neq(coarseness);
        let sets = if is_coarse { 1 } else { SETS };
        world.resource_mut::<Refinement>().set_if_neq(Refinement { sets, per_update: 1 });
    }

    fn draw(&mut self, is_coarse: bool) {
        let pipelines = self.app.world().resource::<Report>().pipelines.len();
        let started = Instant::now();
        self.update();
        let took = started.elapsed();
        self.drawn.take(self.app.world_mut());
        self.pictures += 1;
        let report = self.app.world().resource::<Report>();
        let is_first =
            report.pipelines.len() > pipelines || report.passes.keys().any(|pass| pass.starts_with("upload"));
        match is_coarse {
            // What is done once says nothing of the next picture.
            _ if is_first => {}
            true => self.pace.took(took),
            false => self.pace.full_took(took),
        }
        if is_coarse {
            self.settles = Instant::now() + SETTLE;
        }
        let size = self.app.world().resource::<Picture>().size;
        self.shown.pixels = size.to_array();
        self.shown.took = took;
        self.shown.is_coarse = is_coarse;
        log::debug!("picture {}: {} x {} in {took:?}", self.pictures, size.x, size.y);
    }

    /// Adds a set of samples. The picture is drawn anew when there are twice as many, as it takes longer than they do and changes ever less.
    fn refine(&mut self) {
        let before = self.shown.refined;
        self.app.world_mut().resource_mut::<Drawing>().0 = false;
        self.update();
        self.app.world_mut().resource_mut::<Drawing>().0 = true;
        let Some((done, wanted)) = self.shown.refined else { return };
        self.is_stuck = before == self.shown.refined;
        if done.is_power_of_two() || done == wanted || self.is_stuck {
            self.draw(false);
        }
    }

    fn has_to_refine(&self) -> bool {
        !self.is_stuck && self.shown.refined.is_some_and(|(done, wanted)| done < wanted)
    }

    /// Brings everything up to date, and tells what went wrong.
    fn update(&mut self) {
        let world = self.app.world_mut();
        let measure = world.resource::<OpenPanels>().report;
        let has_reloaded = std::mem::take(&mut self.has_reloaded);
        prepare_report(world, measure, has_reloaded);
        let started = Instant::now();
        self.app.update();
        let world = self.app.world_mut();
        world.resource_mut::<Report>().spent("passes", started);
        let started = Instant::now();
        let failure = world.resource_mut::<Failure>().take();
        let waited = world.resource::<Gpu>().wait("drawing").and_then(|()| collect_times(world));
        world.resource_mut::<Report>().spent("draw", started);
        if has_reloaded {
            let timeline = world.resource::<Report>().timeline.clone();
            world.insert_resource(LastReload(timeline));
        }
        let failure = failure.or(waited.err()).map(|error| error.to_string());
        if let Some(failure) = &failure {
            log::error!("{failure}");
            self.log.tell(Level::Error, failure.clone());
        }
        self.shown.failure = failure;
        self.shown.refined = refined(world, SETS);
        count(world);
        self.tell_problems();
    }
}

/// Makes the report that of the picture to come, to which the reading of what it shows belongs.
fn prepare_report(world: &mut World, measure: bool, has_reloaded: bool) {
    let mut report = world.resource_mut::<Report>();
    report.passes.clear();
    if !has_reloaded {
        report.timeline.clear();
    }
    report.measure = measure;
    if !measure {
        world.remove_resource::<PassTimer>();
    } else if !world.contains_resource::<PassTimer>()
        && let Some(timer) = PassTimer::new(world.resource::<Gpu>())
    {
        world.insert_resource(timer);
    }
}

fn collect_times(world: &mut World) -> Result<(), GpuError> {
    let times = world.resource_scope(|world, gpu: Mut<Gpu>| match world.get_resource_mut::<PassTimer>() {
        Some(mut timer) => timer.collect(&gpu),
        None => Ok(Vec::new()),
    })?;
    let mut report = world.resource_mut::<Report>();
    for (pass, milliseconds) in times {
        report.took(pass, milliseconds);
    }
    Ok(())
}

/// Counts what ran.
fn count(world: &mut World) {
    world.resource_scope(|world, mut totals: Mut<Totals>| {
        for (pass, record) in &world.resource::<Report>().passes {
            *totals.0.entry(pass).or_default() += record.runs;
        }
    });
}
