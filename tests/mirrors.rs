//! The structs that Rust writes and shaders read have the same fields at the same places, and every shader is valid.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use naga::valid::{Capabilities, ValidationFlags, Validator};
use tyndall::gpu::shader;
use tyndall::mirrors::{self, Mirror};

/// The generated modules, for two volumes of which the shader interpolates one.
fn shaders() -> Vec<(&'static str, naga::Module, String)> {
    let generated = mirrors::generated_modules();
    [
        "gbuffer",
        "scattering_texels",
        "scattered_texels",
        "gather",
        "scattered_radiosity",
        "combine",
        "surface",
        "light_cells",
        "preclassify",
        "light_volume",
        "light_network",
        "light_escape",
        "scattered_light",
        "diffusion",
        "shared_light",
        "summed_light",
        "eye_light",
        "dimmed_gbuffer",
        "raycast",
        "raycast_parts",
        "tonemap",
    ]
    .into_iter()
    .map(|name| {
        let text = shader::expand(name, &generated).unwrap();
        let module = naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        (name, module, text)
    })
    .collect()
}

#[test]
fn every_shader_is_valid() {
    for (name, module, text) in shaders() {
        let validated = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        assert!(validated.is_ok(), "{name}: {}", validated.unwrap_err().emit_to_string(&text));
    }
}

#[test]
fn structs_have_the_same_fields_at_the_same_offsets() {
    let shaders = shaders();
    for Mirror { shader, name, size, fields } in mirrors::all() {
        let (_, module, _) = shaders.iter().find(|(known, ..)| *known == shader).unwrap();
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
        let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. })) = found else {
            panic!("{shader}.wgsl has no struct {name}");
        };
        let in_shader: Vec<(String, u64)> = members
            .iter()
            .map(|member| (member.name.clone().unwrap_or_default(), u64::from(member.offset)))
            .collect();
        let in_rust: Vec<(String, u64)> =
            fields.iter().map(|(name, offset)| ((*name).to_owned(), *offset)).collect();
        assert_eq!(in_shader, in_rust, "{shader}.wgsl, struct {name}");
        assert_eq!(u64::from(*span), size, "{shader}.wgsl, struct {name}");
    }
}

#[test]
fn an_import_that_does_not_exist_is_named_with_its_place() {
    let error =
        shader::expand("broken", &[("broken", "// one\n#import nowhere\n".into())]).unwrap_err().to_string();
    assert_eq!(error, "broken.wgsl:2: there is no shader `nowhere` to import");
}
