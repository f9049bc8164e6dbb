//! The draws of a frame, handed in a few at a time.

use super::{Drawn, Targets};
use crate::gpu::{Draw, Gpu, GpuError, begin_part, ends};
use std::ops::Range;
use std::sync::Arc;

/// Instances of one mesh, and what they are drawn with.
#[derive(Clone)]
pub(super) struct Step<'a> {
    pub pipeline: Arc<Draw>,
    pub bind_group: wgpu::BindGroup,
    /// Where its look begins in the buffer of all.
    pub look: u32,
    pub mesh: &'a Drawn<'a>,
    pub indices: Range<u32>,
    pub instances: Range<u32>,
}

/// Triangles that an adapter which is a program is given at once: it keeps about 150 bytes of each until it has drawn them.
const MOST_IN_SOFTWARE: u32 = 5 << 15;

impl<'a> Step<'a> {
    fn triangles(&self) -> u64 {
        u64::from(self.indices.end - self.indices.start) / 3
            * u64::from(self.instances.end - self.instances.start)
    }

    /// The same in pieces of at most so many triangles.
    fn pieces(self, most: u32) -> impl Iterator<Item = Self> + use<'a> {
        let of_each = (self.indices.end - self.indices.start) / 3;
        let instances = (most / of_each.max(1)).max(1);
        let indices = 3 * of_each.clamp(1, most);
        let (all_instances, all_indices) = (self.instances.clone(), self.indices.clone());
        ranges(all_instances, instances).flat_map(move |instances| {
            let step = self.clone();
            ranges(all_indices.clone(), indices).map(move |indices| Self {
                indices,
                instances: instances.clone(),
                ..step.clone()
            })
        })
    }
}

/// A range in pieces of a length.
fn ranges(range: Range<u32>, length: u32) -> impl Iterator<Item = Range<u32>> {
    let end = range.end;
    range.step_by(length as usize).map(move |start| start..end.min(start.saturating_add(length)))
}

/// Draws them all over a cleared target, and answers how many triangles that were.
pub(super) fn submit(
    gpu: &Gpu,
    steps: Vec<Step>,
    targets: &Targets,
    (clear, height): (wgpu::Color, u32),
    places: &wgpu::Buffer,
    timing: Option<wgpu::RenderPassTimestampWrites>,
) -> Result<u64, GpuError> {
    let most = if gpu.is_software() { MOST_IN_SOFTWARE } else { u32::MAX };
    let pieces: Vec<Step> = steps.into_iter().flat_map(|step| step.pieces(most)).collect();
    let batches = batches(&pieces, u64::from(most));
    let last = batches.len() - 1;
    let mut before = None;
    for (index, batch) in batches.into_iter().enumerate() {
        let timing = timing.as_ref().and_then(|all| ends(all, index == 0, index == last));
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("surface") });
        let part = ((index == 0).then_some(clear), index == last);
        let views = (&targets.colour.view, &targets.depth.view);
        let mut pass = begin_part(&mut encoder, "surface", part, views, timing);
        for step in batch {
            step.pipeline.begin(&mut pass, &step.bind_group, &[step.look]);
            step.mesh.draw(&mut pass, height, places, step);
        }
        drop(pass);
        let submission = gpu.queue.submit([encoder.finish()]);
        // One is drawn while the next is written down.
        if let Some(submission) = before.replace(submission) {
            gpu.wait_for(Some(submission), "drawing meshes")?;
        }
    }
    Ok(pieces.iter().map(Step::triangles).sum())
}

/// Neighbours that are handed in together; at least one batch, which clears the target.
fn batches<'s, 'a>(steps: &'s [Step<'a>], most: u64) -> Vec<&'s [Step<'a>]> {
    let mut batches = Vec::new();
    let (mut start, mut triangles) = (0, 0);
    for (index, step) in steps.iter().enumerate() {
        if triangles > 0 && triangles + step.triangles() > most {
            batches.push(&steps[start..index]);
            (start, triangles) = (index, 0);
        }
        triangles += step.triangles();
    }
    batches.push(&steps[start..]);
    batches
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_cut_into_even_pieces() {
        assert_eq!(ranges(3..10, 3).collect::<Vec<_>>(), [3..6, 6..9, 9..10]);
        assert!(ranges(0..5, u32::MAX).eq(std::iter::once(0..5)));
        assert_eq!(ranges(4..4, 7).count(), 0);
    }
}
