//! How much a ray takes, and how it is shared out over several draws where that is more than one invocation may do.

use super::pipeline::Variant;
use crate::gpu::{Draw, Filtering, Gpu, GpuError, ends, storage, uniform_buffer};
use crate::mirrors::mirror;
use crate::passes::light_volume::cells::NEAR_SAMPLES;
use crate::passes::voxels::Reading;
use crate::view::Pixels;
use glam::{DMat3, DVec3, UVec2};

mirror! {
    /// Mirror of `Part` in `shaders/raycast_parts.wgsl`.
    "raycast_parts":
    pub(crate) struct PartUniform as "Part" {
        corner: UVec2,
        size: UVec2,
        is_first: u32,
    }
}

/// Iterations of loops that an invocation may go through. Mesa's software adapters end every loop of one after 65,535 of all its loops together, without a
/// word; other drivers lose a device that is busy for seconds.
const MOST_ITERATIONS: u64 = 64_000;

/// Invocations that a software adapter runs in step: a loop that one of them is in counts for all.
const LANES: u64 = 8;

/// How much more than each of them invocations in step go through together where volumes take turns: beside the edge of a volume, one is in
/// a long turn of another while its neighbours change between the two.
const APART: u64 = 3;

/// Segments between two looks at the bricks, unless those are more than an invocation may do.
const RUN: u64 = 16;

/// Segments of a volume that a ray is cut into at most, beyond which numbers of 32 bits no longer count them.
pub const MOST_SEGMENTS: f64 = (1 << 20) as f64;

/// Numbers that are kept of a ray beside one for each volume, see `shaders/raycast_parts.wgsl`.
const NUMBERS: u64 = 6;

/// Bytes of what is kept of rays at a time. A picture that takes more is drawn in bands.
const KEPT_BYTES: u64 = 32 << 20;

/// Draws that are handed in before the first of them is waited for.
const AHEAD: u64 = 64;

/// What one volume takes of a ray.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Segments at most.
    pub segments: u64,
    /// Leaps over bricks that are empty, at most.
    pub leaps: u64,
}

impl Stretch {
    /// For axes of a volume and a step in one unit.
    pub fn new(axes: DMat3, step: f64, bricks: [u32; 3]) -> Self {
        let segments = (longest(axes) / step).clamp(0.0, MOST_SEGMENTS).ceil() as u64 + 1;
        // Each leap ends in another brick, or just in front of one.
        let crossed: u64 = bricks.into_iter().map(u64::from).sum();
        Self { segments, leaps: segments.min(2 * crossed + 2) }
    }
}

/// The longest way through a box with these edges.
pub fn longest(axes: DMat3) -> f64 {
    let signs =
        [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, -1.0)];
    signs.into_iter().map(|signs| (axes * signs).length()).fold(0.0, f64::max)
}

/// How rays are shared out: constants of the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Segments of a run.
    run: u64,
    /// Work after which an invocation stops.
    most_work: u64,
    of_segment: u64,
    of_leap: u64,
    of_turn: u64,
}

impl Default for Share {
    fn default() -> Self {
        Self { run: RUN, most_work: 0, of_segment: 0, of_leap: 0, of_turn: 0 }
    }
}

/// What a run takes beside its segments: the last look of each of its loops.
const OF_RUN: u64 = 3;

/// How often rays are gone on with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// None where one draw does all.
    pub share: Option<Share>,
    /// Draws.
    pub draws: u64,
}

impl Plan {
    /// For volumes that a ray goes through, with what else the shader is made for.
    pub fn new(stretches: &[Stretch], variant: &Variant, lights: u32) -> Self {
        let volumes = stretches.len() as u64;
        // Runs of one volume fall together; leaps do so only by chance.
        let apart = if volumes == 1 { 1 } else { APART };
        let (budget, of_leap) = (MOST_ITERATIONS / apart, LANES / apart);
        let of_segment = of_segment(variant, lights);
        let of_turn = 2 * volumes + variant.kinds.lights() + 4;
        let segments: u64 = stretches.iter().map(|stretch| stretch.segments).sum();
        let leaps: u64 = stretches.iter().map(|stretch| stretch.leaps).sum();
        let turns = if volumes == 1 { 1 } else { segments };
        let work = |run: u64, turns: u64| {
            turns * of_turn + (segments / run + turns) * OF_RUN + segments * of_segment + leaps * of_leap
        };
        if work(RUN, turns) <= budget {
            return Self { share: None, draws: 1 };
        }
        let run = (budget / 2 / of_segment).clamp(1, RUN);
        // What is begun before the work is looked at again.
        let begun = run * of_segment + OF_RUN + of_turn + of_leap;
        let most_work = budget.saturating_sub(begun).max(1);
        let draws = work(run, turns).div_ceil(most_work.saturating_sub(of_turn + OF_RUN).max(1)) + 1;
        Self { share: Some(Share { run, most_work, of_segment, of_leap, of_turn }), draws }
    }
}

/// Iterations of loops that a segment takes at most: its own, and those over lights and over what is interpolated by hand.
fn of_segment(variant: &Variant, lights: u32) -> u64 {
    let by_hand = |reading: &Reading| reading.filtering == Filtering::Shader && !reading.is_nearest;
    let texel = if variant.readings.iter().any(by_hand) { 5 } else { 0 };
    let surface = if variant.manners.iter().any(|manner| manner.has_surfaces) { 9 } else { 0 };
    let near = u64::from(variant.near.iter().copied().max().unwrap_or(0));
    let light = if variant.light_filtering == Filtering::Shader { 9 } else { 0 };
    let light = light + if near > 0 { near * NEAR_SAMPLES * (1 + texel) + 1 } else { 0 };
    1 + 2 * texel + variant.kinds.loops(u64::from(lights), surface.max(6 * texel), light)
}

/// The WGSL module `parts`, and the binding of what it is about.
pub fn module(share: Option<Share>, binding: usize) -> (&'static str, String) {
    let Share { run, most_work, of_segment, of_leap, of_turn } = share.unwrap_or_default();
    let text = format!(
        "const IN_PARTS = {};\nconst PART_BINDING = {binding};\n// Segments between two looks at the bricks: lanes that march together \
         stay together.\nconst RUN = {run}.0;\nconst MOST_WORK = {most_work}u;\nconst WORK_OF_SEGMENT = {of_segment}u;\n\
         const WORK_OF_RUN = {OF_RUN}u;\nconst WORK_OF_LEAP = {of_leap}u;\nconst WORK_OF_TURN = {of_turn}u;\n",
        share.is_some()
    );
    ("parts", text)
}

/// What is kept of rays from one draw to the next.
#[derive(Debug, Default)]
pub struct Rays(Option<wgpu::Buffer>);

/// What is drawn: rectangles of a picture, each with resources of its own, onto a target with a colour beside them all.
pub struct Rectangles<'a> {
    pub parts: Vec<(Pixels, Vec<wgpu::BindingResource<'a>>)>,
    pub beside: wgpu::Color,
    pub target: &'a wgpu::TextureView,
}

impl Rays {
    /// Draws rectangles, and goes on with each ray as often as planned.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        draw: &Draw,
        (plan, volumes): (Plan, usize),
        Rectangles { parts, beside, target }: Rectangles,
        timing: Option<wgpu::RenderPassTimestampWrites>,
    ) -> Result<(), GpuError> {
        let numbers = 4 * (NUMBERS + volumes as u64);
        let bands: Vec<_> = parts
            .iter()
            .flat_map(|(pixels, resources)| bands(pixels, numbers).map(move |band| (band, resources)))
            .collect();
        let bytes = numbers * bands.iter().map(|(band, _)| band.count()).max().unwrap_or(0);
        if self.0.as_ref().is_none_or(|kept| kept.size() != bytes.max(16)) {
            self.0 = None;
        }
        let kept = self.0.get_or_insert_with(|| storage(gpu, "rays", bytes));
        let mut load = wgpu::LoadOp::Clear(beside);
        let last = (bands.len().saturating_sub(1), plan.draws - 1);
        for (index, (band, resources)) in bands.into_iter().enumerate() {
            let bind = |is_first| {
                let part = uniform_buffer(gpu, "part", &PartUniform::new(&band, is_first));
                let own = [part.as_entire_binding(), kept.as_entire_binding()];
                draw.bind(gpu, &[resources.clone(), own.to_vec()].concat())
            };
            let bound = [bind(true), bind(false)];
            for turn in 0..plan.draws {
                let timing =
                    timing.as_ref().and_then(|all| ends(all, (index, turn) == (0, 0), (index, turn) == last));
                let rectangle = [band.columns.clone(), band.rows.clone()];
                draw.cover_part(gpu, &bound[usize::from(turn > 0)], rectangle, load, target, timing);
                load = wgpu::LoadOp::Load;
                if (turn + 1) % AHEAD == 0 {
                    gpu.wait("casting rays")?;
                }
            }
        }
        Ok(())
    }
}

impl PartUniform {
    fn new(Pixels { columns, rows }: &Pixels, is_first: bool) -> Self {
        Self {
            corner: UVec2::new(columns.start, rows.start),
            size: UVec2::new(columns.len() as u32, rows.len() as u32),
            is_first: u32::from(is_first),
        }
    }
}

/// The bands of a rectangle of which so many bytes can be kept for each pixel.
fn bands(Pixels { columns, rows }: &Pixels, bytes: u64) -> impl Iterator<Item = Pixels> {
    let high = (KEPT_BYTES / (bytes * columns.len().max(1) as u64)).max(1) as usize;
    let (columns, rows) = (columns.clone(), if columns.is_empty() { 0..0 } else { rows.clone() });
    rows.clone().step_by(high).map(move |start| Pixels {
        columns: columns.clone(),
        rows: start..(start + high as u32).min(rows.end),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_a_rectangle_once_and_keep_within_bounds() {
        for (columns, rows, bytes) in
            [(3..2000, 5..1900, 28), (0..70_000, 0..3, 4000), (0..9, 7..8, 28), (5..5, 0..9, 28)]
        {
            let whole = Pixels { columns: columns.clone(), rows: rows.clone() };
            let all: Vec<_> = bands(&whole, bytes).collect();
            assert_eq!(all.iter().map(Pixels::count).sum::<u64>(), whole.count());
            assert!(all.windows(2).all(|pair| pair[0].rows.end == pair[1].rows.start));
            assert!(all.iter().all(|band| band.rows.len() == 1 || band.count() * bytes <= KEPT_BYTES));
        }
    }

    #[test]
    fn a_box_is_longest_from_corner_to_corner() {
        assert!((longest(DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.0))) - 3.0).abs() < 1e-12);
        let skewed = DMat3::from_cols(DVec3::X, DVec3::new(-1.0, 1.0, 0.0), DVec3::Z);
        assert!((longest(skewed) - 6f64.sqrt()).abs() < 1e-12);
        // Leaps are no more than there are bricks to leap over.
        let stretch = Stretch::new(DMat3::from_diagonal(DVec3::new(100.0, 0.1, 0.1)), 0.01, [100, 1, 1]);
        assert_eq!((stretch.segments, stretch.leaps), (10_002, 206));
    }
}
