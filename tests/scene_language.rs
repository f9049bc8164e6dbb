//! What can be written in a scene, and what becomes of it.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

#[path = "scene_language/numbers.rs"]
mod numbers;

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use tyndall::prelude::*;
use tyndall::render::load_scene;
use tyndall::scene::{Override, Problem, SceneDocument, SceneEntities, Severity};
use tyndall_turntable::{Turntable, TurntablePlugin};

fn app() -> App {
    let mut app = App::new();
    app.add_plugins(TyndallPlugins).add_plugins(TurntablePlugin);
    app
}

/// A folder with the files of a scene; `scene.ron` is the scene.
struct Files(tempfile::TempDir);

impl Files {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        files.iter().for_each(|(name, text)| folder.write(name, text));
        folder
    }

    fn scene(entities: &str) -> Self {
        Self::new(&[("scene.ron", &format!("(entities: {{ {entities} }})"))])
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn path(&self) -> PathBuf {
        self.0.path().join("scene.ron")
    }

    fn load_into(&self, app: &mut App, overrides: &[&str]) -> SceneDocument {
        let overrides: Vec<Override> = overrides.iter().map(|text| text.parse().unwrap()).collect();
        load_scene(app, &self.path(), &overrides)
    }

    /// The world that the scene becomes. It must have no errors.
    fn load(&self, overrides: &[&str]) -> App {
        let mut app = app();
        let document = self.load_into(&mut app, overrides);
        assert!(!document.has_errors(), "{:?}", errors(&document.problems));
        app
    }

    fn errors(&self, overrides: &[&str]) -> Vec<String> {
        errors(&self.load_into(&mut app(), overrides).problems)
    }
}

fn errors(problems: &[Problem]) -> Vec<String> {
    let errors = problems.iter().filter(|problem| problem.severity == Severity::Error);
    errors
        .map(|problem| format!("{}; {}", problem.message, problem.help.clone().unwrap_or_default()))
        .collect()
}

fn get<T: Component + Clone>(app: &App, name: &str) -> T {
    let entity = app.world().resource::<SceneEntities>().0[name];
    app.world().get::<T>(entity).cloned().unwrap_or_else(|| panic!("`{name}` lacks it"))
}

fn has<T: Component>(app: &App, name: &str) -> bool {
    app.world().get::<T>(app.world().resource::<SceneEntities>().0[name]).is_some()
}

#[test]
fn a_component_without_fields_is_its_default() {
    let app = Files::scene(
        r#""all": ( Transform: (), ViewCamera: (), DirectionalLight: (), Phong: (), TransferFunction: (), RayCast: (), Turntable: (), ScatteringMaps: () ),
        "ball": ( Mesh: Sphere() ), "bare": ( Mesh: Sphere, VolumeLighting: Gradient ), "lit": ( VolumeLighting: EmissionAbsorption, Shading: Scattering ),
        "eye": ( ViewCamera: (projection: Perspective()) ), "empty": ()"#,
    )
    .load(&[]);
    assert_eq!(get::<Transform>(&app, "all"), Transform::default());
    assert_eq!(get::<ViewCamera>(&app, "all"), ViewCamera::default());
    assert_eq!(get::<ViewCamera>(&app, "eye"), ViewCamera::default());
    assert_eq!(get::<DirectionalLight>(&app, "all"), DirectionalLight::default());
    assert_eq!(get::<Phong>(&app, "all"), Phong::default());
    assert_eq!(get::<TransferFunction>(&app, "all"), TransferFunction::default());
    assert_eq!(get::<RayCast>(&app, "all"), RayCast::default());
    assert_eq!(get::<Turntable>(&app, "all"), Turntable::default());
    assert_eq!(get::<ScatteringMaps>(&app, "all"), ScatteringMaps::default());
    assert_eq!(get::<Mesh>(&app, "ball"), Mesh::default());
    assert_eq!(get::<Mesh>(&app, "bare"), Mesh::default());
    let gradient = VolumeLighting::Gradient { ambient: 0.2, diffuse: 0.7, specular: 0.3, shininess: 16.0 };
    assert_eq!(get::<VolumeLighting>(&app, "bare"), gradient);
    assert_eq!(get::<VolumeLighting>(&app, "lit"), VolumeLighting::default());
    assert_eq!(get::<Shading>(&app, "lit"), Shading::default());
}

#[test]
fn every_field_of_every_component_can_be_written() {
    let files = Files::new(&[(
        "scene.ron",
        r#"(
        millimetres_per_unit: 10, background: (0.1, 0.2, 0.3), shading: Local, include: [],
        entities: {
            "eye": ( ViewCamera: (eye: (1, 2, 3), target: (0.5, 0, -1e-1), up: (0, 0, 1), projection: Orthographic(height: 3), exposure: -1.5, gamma: 1.0) ),
            "sun": ( DirectionalLight: (direction: (-1.0, -2.0, -0.5), irradiance: (3.0, 2.9, 2.7)), Turntable: (degrees_per_second: -9.0, axis: (1.0, 0.0, 0.0)) ),
            "file": ( Mesh: File("meshes/ball.obj"), Transform: (translation: (1, 2, 3), rotation: (10, 20, 30), scale: (1, 2, 3)) ),
            "sphere": ( Mesh: Sphere(radius: 2, subdivisions: 3), Transform: (scale: 2) ),
            "box": ( Mesh: Box(size: (1, 2, 3)), Shading: Local ),
            "plane": ( Mesh: Plane(size: (4, 5)) ),
            "room": ( Mesh: CornellBox, Phong: (ambient: (0.1, 0.1, 0.1), diffuse: (1, 0, 0), specular: (0.04, 0.04, 0.04), shininess: 200.0) ),
            "bone": (
                Volume: Raw(path: "bone.raw.gz", size: (3, 4, 5), format: I16, endian: Big, spacing: (0.5, 0.5, 1.0), skip_bytes: 352),
                TransferFunction: (domain: (-1.0, 255.0), points: [(0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (0.9, 0.8, 0.6), 0.6)],
                    iso: [(value: 0.5, width: 0.1, color: (1.0, 0.0, 0.0), absorption: 2.0)], entries: 64, classification: Post, opacity_length: 0.5),
                VolumeLighting: Gradient(ambient: 0.1, diffuse: 0.2, specular: 0.4, shininess: 8.0),
                RayCast: (step: 0.5, early_termination: 1.0, skip_empty: false),
            ),
            "auto": ( TransferFunction: (domain: Auto, opacity_length: Auto) ),
        },
    )"#,
    )]);
    let app = files.load(&[]);
    let settings = app.world().resource::<SceneSettings>();
    let expected = SceneSettings {
        millimetres_per_unit: 10.0,
        background: Vec3::new(0.1, 0.2, 0.3),
        shading: Shading::Local,
        ..Default::default()
    };
    assert_eq!(*settings, expected);
    let camera = ViewCamera {
        eye: Vec3::new(1.0, 2.0, 3.0),
        target: Vec3::new(0.5, 0.0, -0.1),
        up: Vec3::Z,
        frame: None,
        projection: Projection::Orthographic { height: 3.0 },
        exposure: -1.5,
        gamma: Auto::Value(1.0),
    };
    assert_eq!(get::<ViewCamera>(&app, "eye"), camera);
    let turntable = Turntable { degrees_per_second: -9.0, axis: Vec3::X };
    assert_eq!(get::<Turntable>(&app, "sun"), turntable);
    assert_eq!(get::<DirectionalLight>(&app, "sun").irradiance, Vec3::new(3.0, 2.9, 2.7));
    let Mesh::File { path, .. } = get(&app, "file") else { panic!() };
    assert_eq!((path.written(), path.path()), ("meshes/ball.obj", &*files.0.path().join("meshes/ball.obj")));
    assert_eq!(get::<Transform>(&app, "file").scale, Scale::PerAxis(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(get::<Transform>(&app, "sphere").scale, Scale::Uniform(2.0));
    assert_eq!(get::<Mesh>(&app, "sphere"), Mesh::Sphere { radius: 2.0, subdivisions: 3 });
    assert_eq!(get::<Mesh>(&app, "box"), Mesh::Box { size: Vec3::new(1.0, 2.0, 3.0) });
    assert_eq!(get::<Mesh>(&app, "plane"), Mesh::Plane { size: Vec2::new(4.0, 5.0) });
    assert_eq!(get::<Mesh>(&app, "room"), Mesh::CornellBox);
    assert_eq!(get::<Phong>(&app, "room").shininess, 200.0);
    let Volume::Raw { size, format, endian, spacing, skip_bytes, .. } = get(&app, "bone") else { panic!() };
    assert_eq!((size, format, endian), (UVec3::new(3, 4, 5), SampleFormat::I16, Endian::Big));
    assert_eq!((spacing, skip_bytes), (Vec3::new(0.5, 0.5, 1.0), 352));
    let function: TransferFunction = get(&app, "bone");
    assert_eq!(function.domain, Auto::Value(Vec2::new(-1.0, 255.0)));
    assert_eq!(function.points[1], ControlPoint(1.0, Vec3::new(0.9, 0.8, 0.6), 0.6));
    assert_eq!(function.iso, [IsoValue { value: 0.5, width: 0.1, color: Vec3::X, absorption: 2.0 }]);
    assert_eq!((function.entries, function.opacity_length), (64, Auto::Value(0.5)));
    assert_eq!(get::<TransferFunction>(&app, "auto"), TransferFunction::default());
    assert_eq!(
        get::<RayCast>(&app, "bone"),
        RayCast { step: 0.5, early_termination: 1.0, skip_empty: false }
    );
}

#[test]
fn the_tables_in_the_documentation_give_the_defaults() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/components");
    let tables = [
        ("directional_light.rs", "DirectionalLight"),
        ("phong.rs", "Phong"),
        ("ray_cast.rs", "RayCast"),
        ("scattering_maps.rs", "ScatteringMaps"),
        ("subsurface.rs", "Subsurface"),
        ("transform.rs", "Transform"),
        ("view_camera.rs", "ViewCamera"),
    ];
    for (file, component) in tables {
        let text = fs::read_to_string(folder.join(file)).unwrap();
        let own = text.split(&format!("pub struct {component} ")).next().unwrap();
        let rows = own.lines().filter_map(|line| line.strip_prefix("/// | `"));
        // The first table; another one may say more of the same fields.
        let mut names = HashSet::new();
        let fields: Vec<String> = rows
            .filter(|row| names.insert(row.split('`').next()))
            .map(|row| {
                let cells: Vec<_> = row.trim_end_matches(" |").split(" | ").collect();
                format!("{}: {}", cells[0].trim_end_matches('`'), cells[cells.len() - 1].trim_matches('`'))
            })
            .collect();
        assert!(!fields.is_empty(), "{file} has no table");
        let both = format!(r#""a": ( {component}: ({}) ), "b": ( {component}: () )"#, fields.join(", "));
        let mut app = Files::scene(&both).load(&[]);
        let values: Vec<String> = ["a", "b"].map(|name| debug(&mut app, name, component)).into();
        assert_eq!(values[0], values[1], "{file}");
    }
}

/// A component's value as text, by the name of its type.
fn debug(app: &mut App, name: &str, component: &str) -> String {
    match component {
        "DirectionalLight" => format!("{:?}", get::<DirectionalLight>(app, name)),
        "Phong" => format!("{:?}", get::<Phong>(app, name)),
        "RayCast" => format!("{:?}", get::<RayCast>(app, name)),
        "ScatteringMaps" => format!("{:?}", get::<ScatteringMaps>(app, name)),
        "Subsurface" => format!("{:?}", get::<Subsurface>(app, name)),
        "Transform" => format!("{:?}", get::<Transform>(app, name)),
        _ => format!("{:?}", get::<ViewCamera>(app, name)),
    }
}

/// The medium of an entity: sigma_a and sigma_s of red, green and blue; g and eta of red.
fn medium(app: &App, name: &str) -> ([[f64; 3]; 2], [f64; 2]) {
    let medium = get::<Subsurface>(app, name).material.coefficients().unwrap();
    ([medium.map(|one| one.sigma_a), medium.map(|one| one.sigma_s)], [medium[0].g, medium[0].eta])
}

#[test]
fn a_medium_is_a_name_or_either_pair_of_coefficients() {
    let app = Files::scene(
        r#""default": ( Subsurface: () ), "marble": ( Subsurface: (material: Preset("Marble")) ),
        "milk": ( Subsurface: (material: Preset("milk")) ),
        "pair": ( Subsurface: (material: Custom(sigma_a: (0.5, 0.25, 0.0), sigma_s: (1, 2, 4))) ),
        "share": ( Subsurface: (material: Custom(sigma_t: (2.0, 4.0, 1e12), albedo: (0.75, 0.0, 1.0), g: -0.5, eta: 1.5)) ),
        "some": ( Subsurface: (material: Custom(sigma_a: Some((0.5, 0.25, 0.0)), sigma_s: Some((1, 2, 4)), sigma_t: None)) ),
        "clear": ( Subsurface: (material: Custom(sigma_a: (0, 0, 0), sigma_s: (0, 0, 0), g: 0.999, eta: 0.5)) ),"#,
    )
    .load(&[]);
    let marble = ([[0.0021, 0.0041, 0.0071], [2.19, 2.62, 3.0]], [0.0, 1.5]);
    assert_eq!(medium(&app, "default"), marble);
    assert_eq!(medium(&app, "marble"), marble);
    assert_eq!(medium(&app, "milk").0[1], [2.55, 3.21, 3.77]);
    let eta = f64::from(1.3_f32);
    assert_eq!(medium(&app, "pair"), ([[0.5, 0.25, 0.0], [1.0, 2.0, 4.0]], [0.0, eta]));
    let most = f64::from(1e12_f32);
    assert_eq!(medium(&app, "share"), ([[0.5, 4.0, 0.0], [1.5, 0.0, most]], [-0.5, 1.5]));
    assert_eq!(get::<Subsurface>(&app, "some"), get::<Subsurface>(&app, "pair"));
    assert_eq!(medium(&app, "clear").0, [[0.0; 3]; 2]);
    let half = Material::Custom {
        sigma_a: Some(Vec3::ONE),
        sigma_s: None,
        sigma_t: None,
        albedo: Some(Vec3::ONE),
        g: 0.0,
        eta: 1.3,
    };
    assert_eq!(half.coefficients(), None);
    assert_eq!(Material::Preset("granite".into()).coefficients(), None);
}

#[test]
fn how_light_is_scattered_can_be_written_beside_a_preset() {
    let app = Files::scene(
        r#"
        "skin": ( Subsurface: (material: Preset("skin"), g: 0.75) ),
        "straight on": ( Subsurface: (material: Preset("skin"), g: Some(1.0)) ),
        "straight back": ( Subsurface: (material: Custom(sigma_a: (1, 1, 1), sigma_s: (2, 2, 2), g: -1.0)) ),"#,
    )
    .load(&[]);
    let plain = Material::Preset("skin".into()).coefficients().unwrap();
    let leaning = get::<Subsurface>(&app, "skin").coefficients().unwrap();
    for (plain, leaning) in plain.into_iter().zip(leaning) {
        assert_eq!((plain.g, leaning.g, leaning.sigma_a), (0.0, 0.75, plain.sigma_a));
        assert!((leaning.sigma_s - 4.0 * plain.sigma_s).abs() < 1e-9 * leaning.sigma_s);
        let (one, other) = (plain.diffusion(), leaning.diffusion());
        assert!((one.sigma_t_prime - other.sigma_t_prime).abs() < 1e-9 * one.sigma_t_prime);
    }
    let straight = get::<Subsurface>(&app, "straight on").coefficients().unwrap();
    assert!(
        straight.iter().all(|medium| medium.sigma_s.is_finite() && medium.diffusion().sigma_s_prime > 0.0)
    );
    assert_eq!(get::<Subsurface>(&app, "straight back").coefficients().unwrap()[0].g, -1.0);
    for (text, told) in [
        ("material: Custom(sigma_a: (1, 1, 1), sigma_s: (2, 2, 2)), g: 0.5", "write `Custom(…, g: 0.5)`"),
        ("material: Preset(\"skin\"), g: 1.01", "from -1 to 1"),
        ("material: Custom(sigma_a: (1, 1, 1), sigma_s: (2, 2, 2), g: -1.01)", "from -1 to 1"),
    ] {
        let told_of = Files::scene(&format!("\"a\": ( Subsurface: ({text}) ),")).errors(&[]);
        assert!(told_of.iter().any(|message| message.contains(told)), "{text}: {told_of:?}");
    }
}

#[test]
fn what_is_to_be_above_0_is_so_on_a_gpu() {
    for (component, field) in [
        ("Volume: Raw(path: \"v.raw\", size: (2, 2, 2), spacing: (1e-45, 1, 1))", "1e-45"),
        ("TransferFunction: (opacity_length: 1e-40, points: [(0.0, (1, 1, 1), 0.5)])", "1e-40"),
    ] {
        let told_of = Files::scene(&format!("\"a\": ( {component} ),")).errors(&[]);
        assert!(told_of.iter().any(|message| message.contains("at least 1.2e-38")), "{field}: {told_of:?}");
    }
}

#[test]
fn everything_about_scattering_can_be_written() {
    let app = Files::scene(
        r#""bunny": (
            Mesh: Sphere(),
            Subsurface: (material: Preset("skin"), model: DirectionalDipole, specular: Some((strength: 0.5, shininess: 8)), local: (shininess: 4)),
            ScatteringMaps: (strategy: Uniform, cameras: 8, samples: 24, candidates: 96, resolution: Texels(1200, 680),
                radius: Millimetres(2.5), bias: 0.01, progressive: false),
        ),
        "plain": ( Mesh: Sphere(), Subsurface: (model: StandardDipole, specular: (strength: 0.1)),
            ScatteringMaps: (strategy: Adaptive, candidates: Auto, resolution: Auto, radius: Auto, bias: Auto) ),
        "matt": ( Mesh: Sphere(), Subsurface: (model: CalibratedDipole, specular: None) ),
        "by default": ( Subsurface: (specular: Some(())) ),
        "from above": ( ScatteringCamera: (target: "bunny", direction: (0.5, -1.0, 0.0)) ),
        "from below": ( ScatteringCamera: (target: "plain") ),"#,
    )
    .load(&[]);
    let bunny = Subsurface {
        material: Material::Preset("skin".into()),
        g: None,
        model: DipoleModel::DirectionalDipole,
        specular: Some(Specular { strength: 0.5, shininess: 8.0 }),
        local: Phong { shininess: 4.0, ..Phong::default() },
    };
    assert_eq!(get::<Subsurface>(&app, "bunny"), bunny);
    let maps = ScatteringMaps {
        strategy: MapStrategy::Uniform,
        cameras: 8,
        samples: 24,
        candidates: Auto::Value(96),
        resolution: MapResolution::Texels(1200, 680),
        radius: SampleRadius::Millimetres(2.5),
        bias: Auto::Value(0.01),
        progressive: false,
    };
    assert_eq!(get::<ScatteringMaps>(&app, "bunny"), maps);
    let plain: Subsurface = get(&app, "plain");
    assert_eq!(plain.specular, Some(Specular { strength: 0.1, shininess: 60.0 }));
    assert_eq!(plain.model, DipoleModel::StandardDipole);
    assert_eq!(get::<ScatteringMaps>(&app, "plain"), ScatteringMaps::default());
    assert_eq!(get::<Subsurface>(&app, "matt"), Subsurface::default());
    assert_eq!(get::<ScatteringMaps>(&app, "matt"), ScatteringMaps::default(), "required");
    let defaults = Subsurface { specular: Some(Specular::default()), ..Subsurface::default() };
    assert_eq!(get::<Subsurface>(&app, "by default"), defaults);
    let camera = ScatteringCamera { target: "bunny".into(), direction: Vec3::new(0.5, -1.0, 0.0) };
    assert_eq!(get::<ScatteringCamera>(&app, "from above"), camera);
    assert_eq!(get::<ScatteringCamera>(&app, "from below").direction, Vec3::NEG_Y);
}

#[test]
fn an_optional_value_can_be_overridden_however_it_is_written() {
    let files = Files::scene(
        r#""some": ( Subsurface: (specular: Some((strength: 0.5))) ), "plain": ( Subsurface: (specular: (strength: 0.5)) ),
        "none": ( Subsurface: (specular: None) ), "empty": ( Subsurface: (specular: Some /* so */ ( ( ) )) ), "default": ( Subsurface: () )"#,
    );
    let specular = |change: &str| {
        let app = files.load(&[change]);
        get::<Subsurface>(&app, change.split('.').next().unwrap()).specular
    };
    let highlight = |strength, shininess| Some(Specular { strength, shininess });
    for name in ["some", "plain", "none", "empty", "default"] {
        assert_eq!(specular(&format!("{name}.Subsurface.specular=None")), None, "{name}");
        let change = format!("{name}.Subsurface.specular=Some((shininess: 9))");
        assert_eq!(specular(&change), highlight(0.2, 9.0), "{name}");
        let change = format!("{name}.Subsurface.specular=(strength: 0.75)");
        assert_eq!(specular(&change), highlight(0.75, 60.0), "{name}");
    }
    for name in ["some", "plain"] {
        assert_eq!(specular(&format!("{name}.Subsurface.specular.strength=0.25")), highlight(0.25, 60.0));
        assert_eq!(specular(&format!("{name}.Subsurface.specular.shininess=9")), highlight(0.5, 9.0));
    }
    assert_eq!(specular("empty.Subsurface.specular.shininess=9"), highlight(0.2, 9.0));
}

#[test]
fn the_materials_that_scenes_share_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/materials");
    let mut materials: Vec<PathBuf> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    materials.sort();
    assert!(materials.len() >= 4, "{materials:?}");
    for path in materials {
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("// "), "{} says what it is", path.display());
        let scene = format!(r#""ball": ( Mesh: Sphere(), Subsurface: File({path:?}) )"#);
        let app = Files::scene(&scene).load(&[]);
        let Material::Preset(name) = get::<Subsurface>(&app, "ball").material else { continue };
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        assert!(name.starts_with(&stem), "{} is {name}", path.display());
    }
}

/// What the cameras of a scene look at, by name.
fn targets(app: &mut App) -> BTreeMap<String, String> {
    let mut cameras = app.world_mut().query::<(&Name, &ScatteringCameraOf)>();
    let world = app.world();
    let targets = cameras.iter(world).map(|(camera, of)| {
        assert!(world.get::<ScatteringCameras>(of.0).unwrap().iter().count() > 0);
        (camera.to_string(), world.get::<Name>(of.0).unwrap().to_string())
    });
    targets.collect()
}

#[test]
fn scattering_cameras_find_their_targets_through_reloads() {
    let text = r#"
        "from above": ( ScatteringCamera: (target: "bunny") ),
        "bunny": ( Mesh: Sphere(subdivisions: 0), Subsurface: () ),
        "candle": ( Mesh: Sphere(subdivisions: 0), Subsurface: (material: Preset("wax")) ),
        "from below": ( ScatteringCamera: (target: "bunny", direction: (0.0, 1.0, 0.0)) ),"#;
    let files = Files::scene(text);
    let mut app = app();
    let mut before: Vec<(Entity, _)> = Vec::new();
    let mut reload = |text: &str| {
        files.write("scene.ron", &format!("(entities: {{ {text} }})"));
        let document = files.load_into(&mut app, &[]);
        let errors = errors(&document.problems);
        app.update();
        let pairs: Vec<String> =
            targets(&mut app).iter().map(|(camera, target)| format!("{camera}: {target}")).collect();
        let mut cameras = app.world_mut().query::<(Entity, Ref<ScatteringCameraOf>)>();
        let now: Vec<_> = cameras.iter(app.world()).map(|(entity, of)| (entity, of.last_changed())).collect();
        let changed = now.iter().filter(|camera| !before.contains(*camera)).count();
        before = now;
        (pairs, changed, errors.len())
    };
    let bunny = ["from above: bunny".to_owned(), "from below: bunny".to_owned()];
    assert_eq!(reload(text), (bunny.to_vec(), 2, 0));
    assert_eq!(reload(text), (bunny.to_vec(), 0, 0), "nothing changed");
    let turned = text.replace("(0.0, 1.0, 0.0)", "(1.0, 1.0, 0.0)");
    assert_eq!(reload(&turned), (bunny.to_vec(), 0, 0), "the same target");
    let other = text.replace(r#"target: "bunny", "#, r#"target: "candle", "#);
    let both = vec!["from above: bunny".to_owned(), "from below: candle".to_owned()];
    assert_eq!(reload(&other), (both.clone(), 1, 0));
    let renamed = other.replace("bunny", "hare");
    assert_eq!(reload(&renamed).0, ["from above: hare", "from below: candle"]);
    assert_eq!(reload(&other).0, both);
    let fewer = other.replace("ScatteringCamera: (target: \"bunny\")", "");
    assert_eq!(reload(&fewer).0, ["from below: candle"]);
    let opaque = other.replace("Subsurface: ()", "Phong: ()");
    assert_eq!((reload(&opaque).2, reload(&other).0), (1, both.clone()), "an error leaves all as it was");
    let own = format!(r#"{other} "self": ( Subsurface: (), ScatteringCamera: (target: "self") )"#);
    assert_eq!(reload(&own).0[2], "self: self");
    assert_eq!(reload(&own).1, 0);
    assert_eq!(reload(&other).0, both);
    let swapped =
        other.replace("\"candle\"", "\"x\"").replace("\"bunny\"", "\"candle\"").replace("\"x\"", "\"bunny\"");
    assert_eq!(reload(&swapped).0, ["from above: candle", "from below: bunny"]);
}

#[test]
fn a_target_made_by_code_is_found_and_forgotten() {
    let mut app = app();
    let camera = app.world_mut().spawn(ScatteringCamera { target: "blob".into(), ..Default::default() }).id();
    app.update();
    assert_eq!(app.world().get::<ScatteringCameraOf>(camera), None);
    let blob = app.world_mut().spawn((Name::new("blob"), Subsurface::default())).id();
    app.update();
    assert_eq!(app.world().get::<ScatteringCameraOf>(camera), Some(&ScatteringCameraOf(blob)));
    app.world_mut().entity_mut(blob).remove::<Subsurface>();
    app.update();
    assert_eq!(app.world().get::<ScatteringCameraOf>(camera), None);
    app.world_mut().entity_mut(blob).insert(Subsurface::default());
    app.update();
    assert!(app.world().get::<ScatteringCameraOf>(camera).is_some());
    app.world_mut().entity_mut(blob).insert(Name::new("drop"));
    app.update();
    assert_eq!(app.world().get::<ScatteringCameraOf>(camera), None);
    app.world_mut().despawn(blob);
    app.update();
}

/// A component of a plugin, with names in it.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
struct Orbit {
    #[reflect(@NameOf("Mesh"))]
    around: String,
    #[reflect(@NameOf("Mesh"))]
    away_from: Option<String>,
    #[reflect(@Names { of: "way", known: &["left", "right"] })]
    way: Option<String>,
}

#[test]
fn plugins_may_ask_for_names() {
    let read = |orbit: &str| {
        let mut app = app();
        app.register_type::<Orbit>();
        let files =
            Files::scene(&format!(r#""sun": ( Mesh: Sphere() ), "far": (), "moon": ( Orbit: ({orbit}) )"#));
        let problems = files.load_into(&mut app, &[]).problems;
        errors(&problems)
    };
    assert_eq!(read(r#"around: "sun""#), [""; 0]);
    assert_eq!(read(r#"around: "sun", way: "Left""#), [""; 0]);
    assert_eq!(read(r#"around: "sum""#), ["there is no entity `sum`; did you mean `sun`?"]);
    let lacking = "the `around` of a `Orbit` needs a `Mesh`, and `far` has none; those with a `Mesh`: `sun`";
    assert_eq!(read(r#"around: "far""#), [lacking]);
    let none = ["there is no entity `x`; those with a `Mesh`: `sun`"];
    assert_eq!(read(r#"around: "sun", away_from: "x""#), none);
    assert_eq!(read(r#"around: "sun", away_from: None"#), [""; 0]);
    let wrong = ["there is no way `lft`; did you mean `left`? known here: left, right"];
    assert_eq!(read(r#"around: "sun", way: "lft""#), wrong);
    assert_eq!(read(r#"around: "sun", way: Some("lft")"#), wrong);
}

#[test]
fn what_other_programs_call_it_is_understood() {
    let cases = [
        (r#"Mesh: Obj("x.obj")"#, "did you mean `File`?"),
        (r#"Mesh: Gltf("x.glb")"#, "did you mean `File`?"),
        (r#"Mesh: Cube()"#, "did you mean `Box`?"),
        (r#"Volume: Nifti("x.nii")"#, "did you mean `File`?"),
        (r#"Volume: dicom("x")"#, "did you mean `File`?"),
        ("Color: (1, 0, 0)", "did you mean `Phong`?"),
        ("Material: ()", "did you mean `Phong` or `Subsurface`?"),
        ("Sun: ()", "did you mean `DirectionalLight`?"),
        ("Camera: ()", "did you mean `ViewCamera`?"),
        ("lookup_table: ()", "did you mean `TransferFunction`?"),
        ("Mesh: Sphere(), Phong: (color: (1, 0, 0))", "did you mean `diffuse`?"),
        ("ViewCamera: (look_at: (1, 0, 0))", "did you mean `target`?"),
        // Of a plugin.
        ("Spin: ()", "did you mean `Turntable`?"),
        ("Turntable: (speed: 3)", "did you mean `degrees_per_second`?"),
    ];
    for (components, expected) in cases {
        let errors = Files::scene(&format!("\"it\": ( {components} )")).errors(&[]);
        assert!(
            errors.iter().any(|error| error.ends_with(&format!("; {expected}"))),
            "{components}: {errors:?}"
        );
    }
    let errors = Files::scene("\"it\": ( Mesh: Sphere() )").errors(&["it.Color.diffuse=(1, 0, 0)"]);
    assert!(errors[0].ends_with("; did you mean `it.Phong.diffuse`?"), "{errors:?}");
}

#[test]
fn what_glows_by_itself_needs_no_light() {
    let dark = |entity: &str| {
        let files = Files::scene(&format!(r#""ball": ( Mesh: Sphere(), {entity} )"#));
        let problems = files.load_into(&mut app(), &[]).problems;
        problems.iter().any(|problem| problem.message.contains("in the dark"))
    };
    assert!(dark("") && dark("Phong: ()") && dark("Subsurface: ()"));
    assert!(!dark("Phong: (ambient: (1, 1, 1))"));
    assert!(dark("Subsurface: (local: (ambient: (1, 1, 1)))"), "it scatters");
    assert!(!dark("Subsurface: (local: (ambient: (1, 1, 1))), Shading: Local"));
    assert!(dark("Subsurface: (), Phong: (ambient: (1, 1, 1))"), "its `Phong` plays no part");
}

#[test]
fn includes_merge_and_paths_start_at_the_file_that_names_them() {
    let files = Files::new(&[
        (
            "scenes/main/scene.ron",
            r#"(include: ["../../parts/a.ron", "../../parts/b.ron"], entities: { "top": ( Mesh: Sphere() ), "bone": ( TransferFunction: File("../../tables/bone.ron") ) })"#,
        ),
        ("parts/a.ron", r#"(include: ["b.ron"], entities: { "a": ( Mesh: File("ball.obj") ) })"#),
        ("parts/b.ron", r#"(entities: { "b": ( Volume: Raw(path: "data/b.raw", size: (1, 1, 1)) ) })"#),
        ("tables/bone.ron", "// A table.\n(entries: 64) // as written"),
    ]);
    let mut app = app();
    let document = load_scene(&mut app, &files.0.path().join("scenes/main/scene.ron"), &[]);
    assert!(!document.has_errors(), "{:?}", errors(&document.problems));
    let names: Vec<_> = document.entities.iter().map(|entity| entity.name.as_str()).collect();
    assert_eq!(names, ["b", "a", "top", "bone"]);
    assert_eq!(document.files.len(), 4, "each file is read once: {:?}", document.files);
    let parts = files.0.path().join("parts").canonicalize().unwrap();
    let Mesh::File { path, .. } = get(&app, "a") else { panic!() };
    assert_eq!(path.path().parent().unwrap().canonicalize().unwrap(), parts);
    let Volume::Raw { path, .. } = get(&app, "b") else { panic!() };
    assert!(path.path().ends_with("parts/data/b.raw"), "{path:?}");
    assert_eq!(get::<TransferFunction>(&app, "bone").entries, 64);
}

#[test]
fn comments_may_stand_anywhere() {
    let text = r#"// head (with [brackets
        /* block /* nested ( */ */ ( // open
        /* a */ entities /* b */ : /* c */ { // d
            /* e */ "ball" /* f */ : /* g */ ( /* h */ Mesh /* i */ : /* j */ Sphere /* k */ ( /* l */ radius: /* m */ 2.0 /* n */, /* o */ ) /* p */, // q
            Transform: ( translation: ( /* x */ 1.0, 2.0 /* y */, 3.0 // z
            ), ), ) /* r */,
        } // s
        , ) // tail"#;
    let files = Files::new(&[("scene.ron", text)]);
    let app = files.load(&[]);
    assert_eq!(get::<Mesh>(&app, "ball"), Mesh::Sphere { radius: 2.0, subdivisions: 5 });
    assert_eq!(get::<Transform>(&app, "ball").translation, Vec3::new(1.0, 2.0, 3.0));
    let app = files.load(&["millimetres_per_unit=10", "ball.Mesh.subdivisions=1", "ball.Transform.scale=2"]);
    assert_eq!(app.world().resource::<SceneSettings>().millimetres_per_unit, 10.0);
    assert_eq!(get::<Mesh>(&app, "ball"), Mesh::Sphere { radius: 2.0, subdivisions: 1 });
}

#[test]
fn carriage_returns_and_a_byte_order_of_letters_beyond_ascii_do_no_harm() {
    let text = "(\r\n    // Ærø\r\n    entities: {\r\n        \"Kugel_ä 球 🎱\": ( Mesh: Sphere() ),\r\n        \"größe\": ( Mesh: Sphere(radius: -1.0) ),\r\n    },\r\n)\r\n";
    let files = Files::new(&[("scene.ron", text)]);
    let document = files.load_into(&mut app(), &[]);
    let places: Vec<_> = document
        .problems
        .iter()
        .map(|problem| problem.place.as_ref().unwrap())
        .map(|place| (place.file.line_column(place.bytes.start), &text[place.bytes.clone()]))
        .collect();
    assert_eq!(places, [((5, 41), "-1.0")]);
    let fine = Files::new(&[("scene.ron", &text.replace("-1.0", "1.0"))]);
    let app = fine.load(&["Kugel_ä 球 🎱.Mesh.radius=3"]);
    assert_eq!(get::<Mesh>(&app, "Kugel_ä 球 🎱"), Mesh::Sphere { radius: 3.0, subdivisions: 5 });
}

#[test]
fn overrides_replace_and_add_values() {
    let files = Files::new(&[
        (
            "scene.ron",
            r#"( // a scene (of three)
        entities: {
            "ball": ( Mesh: Sphere(radius: 1.0) ),
            "big ball": ( Mesh: Sphere() ),
            "v1.2 beta": ( Mesh: Sphere ),
            "v1": (),
            "bone": ( TransferFunction: (points: [(0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (1.0, 1.0, 1.0), 0.5)]) ),
            "shared": ( TransferFunction: File("bone.ron") ),
        })"#,
        ),
        ("bone.ron", "(entries: 64)"),
    ]);
    let app = files.load(&[
        "ball.Mesh.radius=2.0",
        "ball.Mesh.subdivisions = 3",
        "big ball.Mesh.radius=4",
        "v1.2 beta.Mesh.radius=5",
        "v1.Mesh=Box(size: (1.0, 1.0, 2.0))",
        "ball.Phong.shininess=7",
        "ball.Phong.diffuse=(0.5, 0.5, 0.5)",
        "ball.Transform=(scale: 3.0)",
        "big ball.Transform.scale=(1.0, 2.0, 3.0)",
        "bone.TransferFunction.points[1]=(0.9, (0.0, 1.0, 0.0), 0.25)",
        "bone.TransferFunction.points[0].2=0.125",
        "bone.TransferFunction.entries=128",
        "shared.TransferFunction.entries=256",
        "background=(1.0, 0.0, 0.0)",
        "shading=Local",
        "background=(0.0, 1.0, 0.0)",
    ]);
    assert_eq!(get::<Mesh>(&app, "ball"), Mesh::Sphere { radius: 2.0, subdivisions: 3 });
    assert_eq!(get::<Mesh>(&app, "big ball"), Mesh::Sphere { radius: 4.0, subdivisions: 5 });
    assert_eq!(get::<Mesh>(&app, "v1.2 beta"), Mesh::Sphere { radius: 5.0, subdivisions: 5 });
    assert_eq!(get::<Mesh>(&app, "v1"), Mesh::Box { size: Vec3::new(1.0, 1.0, 2.0) });
    let phong = Phong { shininess: 7.0, diffuse: Vec3::splat(0.5), ..Phong::default() };
    assert_eq!(get::<Phong>(&app, "ball"), phong);
    assert_eq!(get::<Transform>(&app, "ball").scale, Scale::Uniform(3.0));
    assert_eq!(get::<Transform>(&app, "big ball").scale, Scale::PerAxis(Vec3::new(1.0, 2.0, 3.0)));
    let function: TransferFunction = get(&app, "bone");
    let points = [ControlPoint(0.0, Vec3::ZERO, 0.125), ControlPoint(0.9, Vec3::Y, 0.25)];
    assert_eq!((function.points.as_slice(), function.entries), (points.as_slice(), 128));
    assert_eq!(get::<TransferFunction>(&app, "shared").entries, 256);
    let settings = app.world().resource::<SceneSettings>();
    assert_eq!((settings.background, settings.shading), (Vec3::Y, Shading::Local));
}

#[test]
fn a_wrong_name_in_an_override_gets_a_suggestion() {
    let files = Files::scene(r#""ball": ( Mesh: Sphere() ), "cube": ( Mesh: Box() )"#);
    let cases = [
        ("bal.Mesh.radius=2", "no entity `bal`; did you mean `ball`?"),
        ("ball.Msh.radius=2", "no component `Msh`; did you mean `ball.Mesh.radius`?"),
        ("ball.Mesh.radus=2", "has no field `radus`; did you mean `radius`?"),
        ("backgruond=(0, 0, 0)", "no setting `backgruond`; did you mean `background`?"),
        ("ball.Volume.size=(1, 1, 1)", "`Volume` is not written in the scene"),
        ("ball.Mesh.radius=big", "expected a number, found `big`"),
        ("ball.Mesh.radius=-2", "`radius` must be above 0"),
    ];
    for (change, expected) in cases {
        let errors = files.errors(&[change]);
        assert!(errors.len() == 1 && errors[0].contains(expected), "{change}: {errors:?}");
    }
    assert!("ball.Mesh.radius".parse::<Override>().is_err());
}

/// What changed since the last look, by entity and component.
fn changes(app: &mut App) -> BTreeMap<String, Vec<&'static str>> {
    fn of<T: Component>(
        world: &mut World,
        label: &'static str,
        found: &mut BTreeMap<String, Vec<&'static str>>,
    ) {
        let mut query = world.query_filtered::<&Name, Changed<T>>();
        for name in query.iter(world) {
            found.entry(name.to_string()).or_default().push(label);
        }
    }
    let mut found = BTreeMap::new();
    let world = app.world_mut();
    of::<Mesh>(world, "Mesh", &mut found);
    of::<Phong>(world, "Phong", &mut found);
    of::<Transform>(world, "Transform", &mut found);
    of::<DirectionalLight>(world, "DirectionalLight", &mut found);
    of::<TransferFunction>(world, "TransferFunction", &mut found);
    if world.is_resource_changed::<SceneSettings>() {
        found.entry("head".into()).or_default().push("SceneSettings");
    }
    world.clear_trackers();
    found
}

#[test]
fn a_reload_touches_only_what_differs() {
    let text = r#"(background: (0.1, 0.1, 0.1), entities: {
        "sun": ( DirectionalLight: (direction: (0.0, -1.0, 0.0)) ),
        "ball": ( Transform: (translation: (1.0, 0.0, 0.0)), Mesh: Sphere(), Phong: (shininess: 8.0) ),
        "bone": ( TransferFunction: (points: [(0.5, (1.0, 1.0, 1.0), 0.5)]) ),
    })"#;
    let files = Files::new(&[("scene.ron", text)]);
    let mut app = app();
    let mut reload = |text: &str| {
        files.write("scene.ron", text);
        let document = files.load_into(&mut app, &[]);
        assert!(!document.has_errors(), "{:?}", errors(&document.problems));
        (changes(&mut app), app.world().resource::<SceneEntities>().0.clone())
    };
    let (first, before) = reload(text);
    assert_eq!(first.len(), 4, "{first:?}");
    assert_eq!(reload(text).0, BTreeMap::new());
    assert_eq!(reload(&format!("// a comment\n{}", text.replace("8.0", "8"))).0, BTreeMap::new());
    assert_eq!(reload(&text.replace("8.0", "9.0")).0, BTreeMap::from([("ball".into(), vec!["Phong"])]));
    let darker = text.replace("8.0", "9.0").replace("background: (0.1", "background: (0.0");
    assert_eq!(reload(&darker).0, BTreeMap::from([("head".into(), vec!["SceneSettings"])]));
    let point = darker.replace("0.5)]", "0.6)]");
    assert_eq!(reload(&point).0, BTreeMap::from([("bone".into(), vec!["TransferFunction"])]));

    let without_component = point.replace(", Phong: (shininess: 9.0)", "");
    let (changed, entities) = reload(&without_component);
    assert_eq!((changed, &entities), (BTreeMap::new(), &before));
    let (_, renamed) = reload(&without_component.replace("\"ball\"", "\"globe\""));
    assert!(renamed["globe"] != before["ball"] && !renamed.contains_key("ball"));
    assert_eq!(renamed["sun"], before["sun"]);
    let removed = without_component.lines().filter(|line| !line.contains("\"ball\"")).collect::<String>();
    assert_eq!(reload(&removed).1.len(), 2);
    assert!(app.world().get_entity(renamed["globe"]).is_err());
}

#[test]
fn what_a_scene_no_longer_says_goes_back() {
    let files =
        Files::scene(r#""ball": ( Transform: (scale: 2.0), Mesh: Sphere(), Phong: (shininess: 8.0) )"#);
    let mut app = files.load(&[]);
    app.update();
    files.write("scene.ron", r#"(entities: { "ball": ( Mesh: Sphere() ) })"#);
    files.load_into(&mut app, &[]);
    assert!(!has::<Phong>(&app, "ball"));
    assert_eq!(get::<Transform>(&app, "ball"), Transform::default(), "a mesh needs one");
    files.write("scene.ron", r#"(entities: { "ball": () })"#);
    files.load_into(&mut app, &[]);
    app.update();
    assert!(!has::<Mesh>(&app, "ball") && !has::<tyndall::loading::LoadedMesh>(&app, "ball"));
}

#[test]
fn a_scene_with_errors_leaves_the_world_as_it_was() {
    let files = Files::scene(r#""ball": ( Mesh: Sphere(radius: 2.0) )"#);
    let mut app = files.load(&[]);
    for broken in ["", "(entities: {", r#"(entities: { "ball": ( Mesh: Sphere(radius: -2.0) ) })"#] {
        files.write("scene.ron", broken);
        assert!(files.load_into(&mut app, &[]).has_errors());
        assert_eq!(get::<Mesh>(&app, "ball"), Mesh::Sphere { radius: 2.0, subdivisions: 5 });
    }
}

#[test]
fn ten_thousand_entities_are_read() {
    let entities: String = (0..10_000)
        .map(|index| {
            format!("\"ball {index}\": ( Mesh: Sphere(radius: {}.5) /* {index} */ ), // b\n", index + 1)
        })
        .collect();
    let started = std::time::Instant::now();
    let app = Files::scene(&entities).load(&["ball 9999.Mesh.radius=1"]);
    eprintln!("10,000 entities, twice: {:?}", started.elapsed());
    assert_eq!(get::<Mesh>(&app, "ball 9998"), Mesh::Sphere { radius: 9999.5, subdivisions: 5 });
}

/// Marsaglia's xorshift: the same numbers everywhere.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit.max(1) as u64) as usize
    }
}

fn mutate(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..1 + random.below(3) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(12)).min(bytes.len());
        match random.below(5) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            3 => bytes.truncate(at),
            _ => {
                let signs = b"()[]{}\"':,/*#r\\-.e9\n";
                bytes.insert(at, signs[random.below(signs.len())]);
            }
        }
    }
    bytes
}

#[test]
fn no_mutation_of_a_scene_makes_the_reader_panic() {
    let scenes = [
        include_str!("../src/cli/templates/scene.ron"),
        include_str!("../src/cli/templates/plugin_scene.ron"),
        r#"(entities: { "a": ( Subsurface: (material: Custom(sigma_a: (1, 1, 1), sigma_s: (1e3, 2, 3)), specular: Some((strength: 0.2))), ScatteringMaps: (resolution: Texels(1, 2), radius: Millimetres(1)) ), "b": ( ScatteringCamera: (target: "a"), Subsurface: (specular: None, material: Preset("wax")) ) })"#,
        r##"(include: ["scene.ron", r#"x.ron"#], entities: { "a\u{e9}b": ( Transform: (scale: (1, 2, 3)), TransferFunction: (domain: Auto, iso: [(), (value: 1e3)]) ), /* ä */ 'b': () })"##,
    ];
    let files = Files::new(&[]);
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let handler = miette::GraphicalReportHandler::new();
    for round in 0..3000 {
        let text = mutate(scenes[round % scenes.len()].as_bytes(), &mut random);
        fs::write(files.path(), &text).unwrap();
        let change = "ball.Mesh.radius=2".parse().unwrap();
        let document = SceneDocument::load(&files.path(), &registry, &[change]);
        for problem in &document.problems {
            assert!(!problem.render(&handler).is_empty());
            assert!(!problem.to_string().is_empty());
        }
    }
}
