//! The light that leaves translucent meshes: what the GPU found, and the same integral summed over every texel that a light reaches.

use crate::components::{DipoleModel, DirectionalLight, Subsurface};
use crate::gpu::{Gpu, GpuError, read_buffer, read_texture};
use crate::optics::calibration::{Calibration, calibration};
use crate::optics::dipole::{DirectionalDipole, Entry, Exit, StandardDipole};
use crate::optics::fresnel::{refract, transmittance};
use crate::optics::medium::Medium;
use crate::optics::moments::Boundary;
use crate::passes::body::Body;
use crate::passes::combine::Radiosity;
use crate::passes::light_gbuffer::{LightView, LightViews};
use crate::passes::medium::LEAST_DISTANCE;
use crate::passes::surface_points::SurfacePoints;
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};

/// A point of a translucent mesh and what leaves there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatteredPoint {
    /// Place in the mesh's own space.
    pub position: Vec3,
    /// Unit normal, in the mesh's own space.
    pub normal: Vec3,
    /// M_o of red, green and blue: the radiance that leaves in a direction omega_o is T(eta, omega_o) M_o.
    pub radiosity: Vec3,
}

/// The points of a translucent mesh as the last frame had them; none before it was drawn.
///
/// # Errors
///
/// If the GPU fails while they are read back.
pub fn scattered_points(world: &World, mesh: Entity) -> Result<Vec<ScatteredPoint>, GpuError> {
    let (Some(points), Some(radiosity)) = (world.get::<SurfacePoints>(mesh), world.get::<Radiosity>(mesh))
    else {
        return Ok(Vec::new());
    };
    let gpu = world.get_resource::<Gpu>().ok_or(GpuError::Missing)?;
    let vertices = read_buffer(gpu, &points.mesh.vertices)?;
    let radiosity = read_buffer(gpu, &radiosity.points)?;
    let vertices = vertices.chunks_exact(24).map(bytemuck::pod_read_unaligned::<[[f32; 3]; 2]>);
    let radiosity = radiosity.chunks_exact(16).map(bytemuck::pod_read_unaligned::<[f32; 4]>);
    let point = |([position, normal], [r, g, b, _]): ([[f32; 3]; 2], [f32; 4])| ScatteredPoint {
        position: position.into(),
        normal: normal.into(),
        radiosity: Vec3::new(r, g, b),
    };
    Ok(vertices.zip(radiosity).map(point).collect())
}

/// What leaves each of these points by the mesh's own model, summed over every texel that each light reaches.
///
/// # Errors
///
/// If the GPU fails while the lights' views are read back.
pub fn brute_force(world: &World, mesh: Entity, points: &[ScatteredPoint]) -> Result<Vec<DVec3>, GpuError> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    let (Some(body), Some(subsurface), Some(views)) =
        (world.get::<Body>(mesh), world.get::<Subsurface>(mesh), world.get::<LightViews>(mesh))
    else {
        return Ok(sums);
    };
    let Some(channels) = Channel::of(subsurface, body.millimetres) else { return Ok(sums) };
    let gpu = world.get_resource::<Gpu>().ok_or(GpuError::Missing)?;
    for view in &views.0 {
        let lit = lit_surface(gpu, view)?;
        let irradiance =
            world.get::<DirectionalLight>(view.light).map_or(Vec3::ZERO, |light| light.irradiance);
        let light_from_mesh = view.view.view_from_body * body.body_from_mesh;
        let normals = light_from_mesh.matrix3.inverse().transpose();
        let area = view.view.texels_per_length().powi(-2);
        for (point, sum) in points.iter().zip(&mut sums) {
            let exit = Exit {
                position: light_from_mesh.transform_point3(point.position.as_dvec3()),
                normal: (normals * point.normal.as_dvec3()).normalize(),
            };
            let found = channels
                .each_ref()
                .map(|channel| lit.iter().map(|entry| channel.carried(entry, &exit)).sum::<f64>());
            *sum += DVec3::from(found) * area * irradiance.as_dvec3();
        }
    }
    Ok(sums)
}

/// Where a texel's light enters.
struct Lit {
    position: DVec3,
    normal: DVec3,
}

/// The texels that a light reaches, in its view's space.
fn lit_surface(gpu: &Gpu, light: &LightView) -> Result<Vec<Lit>, GpuError> {
    let view = &light.view;
    let bytes = read_texture(gpu, &light.target.texture)?;
    let texels = bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned::<[f32; 4]>);
    let lit =
        texels.enumerate().filter(|(_, texel)| texel[..3] != [0.0; 3]).map(|(index, [x, y, z, height])| {
            let (column, row) = (index as u32 % view.size.x, index as u32 / view.size.x);
            let up = view.size.y - 1 - row;
            let across = view.low.truncate()
                + (glam::DVec2::new(f64::from(column), f64::from(up)) + 0.5) / view.texels_per_length();
            Lit {
                position: across.extend(f64::from(height)),
                normal: Vec3::new(x, y, z).as_dvec3().normalize(),
            }
        });
    Ok(lit.collect())
}

/// The model of one channel, lengths in radii of the body.
struct Channel {
    medium: Medium,
    model: Model,
    calibration: Calibration,
}

enum Model {
    Directional(DirectionalDipole),
    Standard(StandardDipole, f64),
}

impl Channel {
    fn of(subsurface: &Subsurface, millimetres: f64) -> Option<[Self; 3]> {
        let channels = subsurface.coefficients()?;
        Some(channels.map(|per_mm| {
            let scaled = Medium {
                sigma_a: per_mm.sigma_a * millimetres,
                sigma_s: per_mm.sigma_s * millimetres,
                ..per_mm
            };
            let boundary = Boundary::exact(scaled.eta);
            let model = match subsurface.model {
                DipoleModel::StandardDipole => Model::Standard(
                    StandardDipole::new(&scaled),
                    4.0 * std::f64::consts::PI * boundary.c_phi_inverse,
                ),
                _ => {
                    let mut dipole = DirectionalDipole::new(&scaled);
                    dipole.least_distance = LEAST_DISTANCE / dipole.diffusion.sigma_t_prime;
                    Model::Directional(dipole)
                }
            };
            let calibration = match subsurface.model {
                DipoleModel::CalibratedDipole => calibration(&per_mm),
                _ => Calibration([1.0, 0.0, 0.0]),
            };
            Self { medium: scaled, model, calibration }
        }))
    }

    /// T(eta, omega_i) max(S_d, 0), calibrated, for light along -z.
    fn carried(&self, lit: &Lit, exit: &Exit) -> f64 {
        let cosine = lit.normal.z;
        let enters = transmittance(cosine, self.medium.eta);
        if enters <= 0.0 {
            return 0.0;
        }
        let s_d = match &self.model {
            Model::Standard(dipole, exitance) => dipole.r_d(exit.position.distance(lit.position)) / exitance,
            Model::Directional(dipole) => {
                let Some(direction) = refract(DVec3::Z, lit.normal, self.medium.eta) else { return 0.0 };
                dipole.s_d(&Entry { position: lit.position, normal: lit.normal, direction }, exit)
            }
        };
        let [c0, c1, c2] = self.calibration.0;
        enters * (c0 + cosine * (c1 + cosine * c2)).max(0.0) * s_d.max(0.0)
    }
}
