//! Pre-integrated tables of the volumes that ask for them.
//!
//! Reads [`Classified`], [`Placement`] and [`RayCast`]; writes [`PreintegratedPairs`]: a 2D texture, rgba32float, of `entries` squared texels,
//! mean colour times optical depth and depth of a segment by the values at its ends, and a row behind them about layers. Runs for a volume
//! when its function or the length of its segments changes; where only a stretch of the function does, for the pairs that meet it.
//! The length is measured in the scene, where the camera plays no part.

use super::classify::Classified;
use super::raycast::parts;
use crate::components::{Classification, Placement, RayCast, SceneSettings};
use crate::gpu::{Gpu, texture_of};
use crate::loading::LoadedVolume;
use crate::optics::preintegration::Preintegration;
use crate::optics::transfer::{Layer, LookupTable};
use crate::report::Report;
use bevy_ecs::prelude::*;
use glam::{DMat3, DVec3, UVec2, Vec4};
use std::time::Instant;

/// The pre-integrated table of a volume.
#[derive(Component, Debug)]
pub(crate) struct PreintegratedPairs {
    /// All pairs, and the row about layers.
    pub view: wgpu::TextureView,
    /// What they are made of, to make but a part of them again.
    table: LookupTable,
    pairs: Preintegration,
}

/// Lengths closer than this are the same, relatively: turning a volume moves the last digits of its size.
const SAME: f64 = 1e-6;

pub(crate) fn preintegrate(
    mut commands: Commands,
    gpu: Res<Gpu>,
    mut volumes: Query<(
        Entity,
        &Classified,
        &LoadedVolume,
        &Placement,
        &RayCast,
        Option<&mut PreintegratedPairs>,
    )>,
    orphans: Query<Entity, (With<PreintegratedPairs>, Without<LoadedVolume>)>,
    settings: Res<SceneSettings>,
    mut report: ResMut<Report>,
) {
    for entity in &orphans {
        commands.entity(entity).remove::<PreintegratedPairs>();
    }
    let (mut bytes, mut made_any) = (0, !orphans.is_empty());
    for (entity, classified, volume, placement, ray_cast, held) in &mut volumes {
        if classified.classification != Classification::PreIntegrated {
            if held.is_some() {
                commands.entity(entity).remove::<PreintegratedPairs>();
                made_any = true;
            }
            continue;
        }
        let side = classified.table.entries.len();
        bytes += 16 * (side * (side + 1)) as u64;
        let length = segment_length(volume, placement, ray_cast, &settings);
        let since = Instant::now();
        let kept = held.filter(|held| (held.pairs.length / length - 1.0).abs() < SAME);
        let (pairs, count) = match kept {
            Some(held) if held.table == classified.table => continue,
            Some(mut held) => {
                // What is kept is moved on, not copied.
                let nothing = Preintegration { side: 0, length, pairs: Vec::new() };
                let mut pairs = std::mem::replace(&mut held.pairs, nothing);
                let count = pairs.update(&held.table, &classified.table);
                (pairs, count)
            }
            None => (Preintegration::new(&classified.table, length), side * side),
        };
        made_any = true;
        let view = upload(&gpu, &pairs, &classified.table);
        report.ran("preintegrate", &[("pairs", count as u64)]);
        report.took("preintegrate", since.elapsed().as_secs_f64() * 1e3);
        commands.entity(entity).insert(PreintegratedPairs { view, table: classified.table.clone(), pairs });
    }
    if made_any {
        report.hold("pre-integrated pairs", bytes);
    }
}

/// Length of a segment of the volume's rays, scene units.
fn segment_length(
    volume: &LoadedVolume,
    placement: &Placement,
    ray_cast: &RayCast,
    settings: &SceneSettings,
) -> f64 {
    let voxel = volume.data.spacing.as_dvec3() / f64::from(settings.millimetres_per_unit);
    let axes = placement.0.matrix3 * DMat3::from_diagonal(voxel);
    let lengths = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
    let whole = axes * DMat3::from_diagonal(DVec3::from(volume.data.size.map(f64::from)));
    (lengths.min_element() * f64::from(ray_cast.step)).max(parts::longest(whole) / parts::MOST_SEGMENTS)
}

fn upload(gpu: &Gpu, pairs: &Preintegration, table: &LookupTable) -> wgpu::TextureView {
    let size = UVec2::new(pairs.side as u32, pairs.side as u32 + 1);
    let texels: Vec<Vec4> = pairs.pairs.iter().copied().chain(about_layers(table)).collect();
    let format = wgpu::TextureFormat::Rgba32Float;
    texture_of(gpu, "pre-integrated pairs", size, format, bytemuck::cast_slice(&texels))
        .create_view(&Default::default())
}

/// For each entry: the depth of the layers below it, and places of layers: the first at it or in cells above, the last in its cell or
/// below. Beyond both ends of the table where there is none.
fn about_layers(table: &LookupTable) -> Vec<Vec4> {
    let layers = &table.layers;
    let texel = |(entry, [_, _, below, _]): (usize, &[f32; 4])| {
        let above = layers.iter().find(|layer| layer.cell >= entry);
        let under = layers.iter().rfind(|layer| layer.cell <= entry);
        let place = |layer: &Layer| layer.position as f32;
        Vec4::new(*below, above.map_or(f32::MAX, place), under.map_or(-1.0, place), 0.0)
    };
    table.cumulative().entries.iter().enumerate().map(texel).collect()
}
