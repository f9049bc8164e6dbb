use super::{AlsoCalled, AssetPath, Leading, Placement, Range, Required, Transform, Unit};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::{Vec2, Vec3};

pub use crate::sources::mesh::Normals;

/// The shape of a surface.
///
/// | variant | fields | range | default |
/// |---|---|---|---|
/// | `File` | `path` of a Wavefront OBJ, PLY, STL or glTF file, plain or in gzip, which alone needs no name | – | – |
/// | | `normals`: `Auto` (the file's; else by its smoothing groups; else `Smooth(40.0)`), `Flat`, or `Smooth(degrees)`: means over the faces that meet at no more than this angle | 0 to 180 | `Auto` |
/// | | `materials`: whether it has the colours of vertices, the materials and the pictures of the file | – | `true` |
/// | `Sphere` | `radius`, scene units; `subdivisions` of an icosahedron | above 0; 0 to 8 | 1.0; 5 |
/// | `Box` | `size` along x, y and z, scene units | above 0 | (1, 1, 1) |
/// | `Plane` | `size` along x and z, scene units; it faces +y | above 0 | (1, 1) |
/// | `CornellBox` | a room of side 2 about the origin, open towards +z | – | – |
///
/// Without a `Phong`, a mesh looks as its file says. With one, the file's colours, materials and pictures are the albedo that `diffuse` is
/// multiplied by, and nothing else of its materials counts. What leaves a mesh with `Subsurface` is multiplied, point by point, by the colours
/// of its vertices and its pictures. Opacity is not drawn.
///
/// One unit of a file is one scene unit; a metre of glTF too. Triangles of a part are turned to face one way, those of a closed part outwards.
///
/// ```ron
/// Mesh: File("../assets/knot.obj")
/// Mesh: File(path: "../assets/gear.obj", normals: Flat)
/// Mesh: Sphere(radius: 2.0)
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[reflect(@AlsoCalled(&["Model", "Geometry", "Object", "Shape", "Surface", "Obj", "Ply", "Stl", "Gltf", "Sphere", "Cube", "Box", "Plane"]))]
#[require(Transform, Placement)]
pub enum Mesh {
    /// Read from a file: Wavefront OBJ, PLY, STL or glTF.
    #[reflect(@AlsoCalled(&["Obj", "Wavefront", "Ply", "Stl", "Gltf", "Glb", "Model", "Load", "Path", "Import"]))]
    File {
        /// The file.
        #[reflect(@Leading, @Required)]
        path: AssetPath,
        /// How its normals come about.
        #[reflect(default)]
        normals: Normals,
        /// Whether it has the colours, materials and pictures of the file.
        #[reflect(default = "yes")]
        #[reflect(@AlsoCalled(&["colours", "colors", "textures", "texture", "material", "mtl"]))]
        materials: bool,
    },
    /// A sphere about the origin.
    #[reflect(@AlsoCalled(&["Ball", "Icosphere", "Globe"]))]
    Sphere {
        /// Scene units.
        #[reflect(default = "one", @Range::positive(), @Unit("scene units"))]
        radius: f32,
        /// How often the twenty faces of the icosahedron are quartered.
        #[reflect(default = "five", @Range::new(0.0, 8.0))]
        subdivisions: u32,
    },
    /// A box about the origin.
    #[reflect(@AlsoCalled(&["Cube", "Cuboid", "Brick"]))]
    Box {
        /// Scene units along x, y and z.
        #[reflect(default = "ones", @Range::positive(), @Unit("scene units"))]
        size: Vec3,
    },
    /// A rectangle in the plane y = 0 that faces +y.
    #[reflect(@AlsoCalled(&["Quad", "Rectangle", "Ground", "Floor", "Grid"]))]
    Plane {
        /// Scene units along x and z.
        #[reflect(default = "one_by_one", @Range::positive(), @Unit("scene units"))]
        size: Vec2,
    },
    /// Floor, ceiling, back and side walls of a room of side 2 about the origin.
    CornellBox,
}

impl Mesh {
    /// The mesh in a file.
    pub fn file(path: impl Into<std::path::PathBuf>) -> Self {
        Self::File { path: AssetPath::new(path), normals: Normals::default(), materials: yes() }
    }
}

impl Default for Mesh {
    fn default() -> Self {
        Self::Sphere { radius: one(), subdivisions: five() }
    }
}

fn yes() -> bool {
    true
}

fn one() -> f32 {
    1.0
}

fn five() -> u32 {
    5
}

fn ones() -> Vec3 {
    Vec3::ONE
}

fn one_by_one() -> Vec2 {
    Vec2::ONE
}
