#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use base64::{Engine, engine::general_purpose::STANDARD};
use glam::{DVec3, Vec3};

use super::super::{
    Samples, Space,
    self_describing::tests::{Folder, is_at, mutate, place_of, values, zlib},
};

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

const IMAGE: &str = r#"WholeExtent="0 1 0 2 0 3" Origin="5 6 7" Spacing="1 2 3""#;
const SCALARS: &str = r#"type="UInt8" Name="s""#;

/// A file of one array of points; `attributes` are of the file, `inner` is what the array holds.
fn vti(attributes: &str, image: &str, array: &str, inner: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" {attributes}>\n<ImageData {image}>\n<Piece Extent=\"0 1 0 2 0 3\">\n\
         <PointData Scalars=\"s\">\n<DataArray {array}>\n{inner}\n</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n"
    )
}

/// Blocks of ten bytes, each packed, behind a table of their lengths.
fn packed(data: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let blocks: Vec<Vec<u8>> = data.chunks(10).map(zlib).collect();
    let lengths = [blocks.len(), 10, data.len() % 10].into_iter().chain(blocks.iter().map(Vec::len));
    (lengths.flat_map(|length| (length as u32).to_le_bytes()).collect(), blocks.concat())
}

#[test]
fn all_forms_of_the_data_are_the_same() {
    let folder = Folder::new();
    let written: String = ramp().iter().map(|value| format!("{value} ")).collect();
    let ascii = folder.read("a.vti", vti("", IMAGE, &format!("{SCALARS} format=\"ascii\""), &written));
    assert_eq!(
        (ascii.size, ascii.spacing, &ascii.samples),
        ([2, 3, 4], Vec3::new(1.0, 2.0, 3.0), &Samples::U8(ramp()))
    );
    assert_eq!((ascii.frame.origin, ascii.frame.space), (DVec3::new(5.0, 6.0, 7.0), Space::World));
    assert_eq!(ascii.notes.len(), 0);
    let binary = format!("{SCALARS} format=\"binary\"");
    let long = [&24_u64.to_be_bytes()[..], &ramp()].concat();
    let file =
        vti("byte_order=\"BigEndian\" header_type=\"UInt64\"", IMAGE, &binary, &STANDARD.encode(&long));
    assert_eq!(folder.read("a.vti", file), ascii);
    // Length and data encoded each for itself.
    let parts = format!("{}{}", STANDARD.encode(24_u32.to_le_bytes()), STANDARD.encode(ramp()));
    assert_eq!(folder.read("a.vti", vti("", IMAGE, &binary, &parts)), ascii);
    let zlib = "compressor=\"vtkZLibDataCompressor\"";
    let (lengths, blocks) = packed(&ramp());
    let parts = format!("{}\n{}", STANDARD.encode(&lengths), STANDARD.encode(&blocks));
    assert_eq!(folder.read("a.vti", vti(zlib, IMAGE, &binary, &parts)), ascii);
    let appended = |attributes: &str, encoding: &str, data: &[u8], offset: usize| {
        let array = format!("{SCALARS} format=\"appended\" offset=\"{offset}\"");
        let text = vti(attributes, IMAGE, &array, "").replace("</VTKFile>\n", "");
        let text = format!("{text}<AppendedData encoding=\"{encoding}\">\n  _");
        folder.read("a.vti", [text.as_bytes(), data, b"\n</AppendedData>\n</VTKFile>"].concat())
    };
    let raw = [&[0xff_u8, b'<'][..], &24_u32.to_le_bytes(), &ramp()].concat();
    assert_eq!(appended("", "raw", &raw, 2), ascii);
    assert_eq!(appended(zlib, "raw", &[lengths, blocks].concat(), 0), ascii);
    let encoded = format!("AAAA{}", STANDARD.encode([&24_u32.to_le_bytes()[..], &ramp()].concat()));
    assert_eq!(appended("", "base64", encoded.as_bytes(), 4), ascii);
}

#[test]
fn every_type_is_read_in_both_byte_orders() {
    let folder = Folder::new();
    let read = |name: &str, number: &[u8]| {
        let mut values_of = [0.0; 2];
        for (big, value) in [false, true].into_iter().zip(&mut values_of) {
            let (mut number, mut length) = (number.to_vec(), (number.len() as u32 * 24).to_le_bytes());
            if big {
                number.reverse();
                length.reverse();
            }
            let data = STANDARD.encode([&length[..], &number.repeat(24)].concat());
            let order = format!("byte_order=\"{}Endian\"", if big { "Big" } else { "Little" });
            let file = vti(&order, IMAGE, &format!("type=\"{name}\" Name=\"s\" format=\"binary\""), &data);
            *value = values(&folder.read("a.vti", file))[5];
        }
        assert_eq!(values_of[0], values_of[1], "{name}");
        values_of[0]
    };
    assert_eq!(read("Int8", &[0xff]), -1.0);
    assert_eq!(read("Int16", &(-300_i16).to_le_bytes()), -300.0);
    assert_eq!(read("UInt16", &60000_u16.to_le_bytes()), 60000.0);
    assert_eq!(read("Int32", &(-70000_i32).to_le_bytes()), -70000.0);
    assert_eq!(read("UInt32", &70000_u32.to_le_bytes()), 70000.0);
    assert_eq!(read("Int64", &(-5_i64).to_le_bytes()), -5.0);
    assert_eq!(read("UInt64", &5_u64.to_le_bytes()), 5.0);
    assert_eq!(read("Float32", &0.5_f32.to_le_bytes()), 0.5);
    assert_eq!(read("Float64", &0.5_f64.to_le_bytes()), 0.5);
}

#[test]
fn arrays_cells_extents_and_directions_are_minded() {
    let folder = Folder::new();
    let bytes = |count: usize| (0..count).map(|value| format!("{} ", value % 256)).collect::<String>();
    let file = |arrays: &str, image: &str, extent: &str| {
        format!(
            "<VTKFile type=\"ImageData\"><ImageData {image}><Piece Extent=\"{extent}\">{arrays}</Piece></ImageData></VTKFile>"
        )
    };
    let array = |name: &str, components: usize, count: usize| {
        format!(
            "<DataArray type=\"UInt8\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{}</DataArray>",
            bytes(components * count)
        )
    };
    let points = format!(
        "<PointData Scalars=\"b\"><DataArray type=\"String\" Name=\"x\">t</DataArray>{}{}{}</PointData>",
        array("v", 2, 24),
        array("a &amp; o", 1, 24),
        array("b", 1, 24)
    );
    let several = file(&points, IMAGE, "0 1 0 2 0 3");
    assert_eq!(
        folder.read("a.vti", &several).notes,
        ["of its 3 arrays `b` is read; `index` chooses another: `v` is 1, `a & o` is 2"]
    );
    assert_eq!(values(&folder.chosen("a.vti", &several, 1, Some(1)).unwrap())[..3], [1.0, 3.0, 5.0]);
    let cells = format!("<CellData>{}</CellData>", array("c", 3, 6));
    let turned = r#"WholeExtent="0 9 0 9 0 9" Origin="5 6 7" Spacing="1 2 3" Direction="0 -1 0 1 0 0 0 0 1""#;
    // x goes along +y, y along -x; the piece begins two points on.
    let colours = folder.read("a.vti", file(&cells, turned, "2 3 0 2 0 3"));
    assert_eq!((colours.size, colours.spacing), ([2, 1, 3], Vec3::new(2.0, 1.0, 3.0)));
    let Samples::Rgba8(samples) = &colours.samples else { panic!() };
    assert_eq!(samples[1], [0, 1, 2, 255]);
    assert!(is_at(place_of(&colours, [1, 0, 0]), [5.0 - 1.0, 6.0 + 2.5, 7.0 + 1.5]));
}

#[test]
fn what_is_known_of_an_array_stands_beside_its_data() {
    let folder = Folder::new();
    let known = "<InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\">\n<Value index=\"0\">\n7\n</Value>\n</InformationKey>";
    let written: String = ramp().iter().map(|value| format!("{value} ")).collect();
    let array = format!("{SCALARS} format=\"ascii\"");
    let plain = folder.read("a.vti", vti("", IMAGE, &array, &written));
    for inner in [format!("{known}\n{written}"), format!("<!-- 9 -->{written}{known}")] {
        assert_eq!(folder.read("a.vti", vti("", IMAGE, &array, &inner)), plain);
    }
    let whole = vti("", IMAGE, &array, &written);
    let cut = &whole[..whole.find("20 21").unwrap()];
    assert!(folder.refusal("a.vti", cut).contains("20 numbers; 2 x 3 x 4 voxels of 1 byte need 24"));
}

#[test]
fn what_is_wrong_is_told() {
    let folder = Folder::new();
    let array = format!("{SCALARS} format=\"ascii\"");
    let whole = vti("", IMAGE, &array, "1 2 3");
    let with = |old: &str, new: &str| {
        assert!(whole.contains(old), "{old}");
        folder.refusal("a.vti", whole.replace(old, new))
    };
    assert!(with("x", "x").contains("3 numbers; 2 x 3 x 4 voxels of 1 byte need 24"));
    assert!(
        with("\"ImageData\"", "\"UnstructuredGrid\"")
            .contains("it holds UnstructuredGrid, no ImageData; resample")
    );
    assert!(
        with("version=\"1.0\" ", "version=\"1.0\" compressor=\"vtkLZ4DataCompressor\"")
            .contains("packed by vtkLZ4DataCompressor; save it with zlib")
    );
    assert!(with("0 1 0 2 0 3", "0 1 0 2").contains("WholeExtent: expected 6 numbers, found `0 1 0 2`"));
    assert!(with("<Piece Extent=\"0 1 0 2 0 3", "<Piece Extent=\"0 1 0 2 3 0").contains("every side"));
    assert!(
        with("<Piece Extent=\"0 1 0 2 0 3", "<Piece Extent=\"0 9000000000 0 9000000000 0 3")
            .contains("limit")
    );
    assert!(with("Spacing=\"1 2 3", "Spacing=\"1 0 3").contains("spacing 1 x 0 x 3"));
    assert!(with("ascii", "appended").contains("offset: an appended array needs one"));
    assert!(with("ascii", "other").contains("expected ascii, binary or appended, found other"));
    assert!(with("UInt8", "String").contains("it has no array of numbers"));
    assert!(with("</Piece>", "</Piece><Piece Extent=\"0 1 0 2 0 3\">").contains("several pieces"));
    assert!(with("</DataArray>", "</DataArra").contains("XML: "));
    let binary = vti("", IMAGE, &format!("{SCALARS} format=\"binary\""), "AAA*");
    assert!(folder.refusal("a.vti", binary).contains("corrupt"));
    let cut = vti("", IMAGE, &format!("{SCALARS} format=\"appended\" offset=\"0\""), "");
    assert!(folder.refusal("a.vti", cut).contains("AppendedData: it is missing"));
}

#[test]
fn damaged_files_never_panic() {
    let written: String = ramp().iter().map(|value| format!("{value} ")).collect();
    let ascii = vti("", IMAGE, &format!("{SCALARS} format=\"ascii\""), &written);
    mutate("a.vti", ascii.as_bytes(), ascii.len());
    let (lengths, blocks) = packed(&ramp());
    let zlib = "compressor=\"vtkZLibDataCompressor\"";
    let parts = format!("{}{}", STANDARD.encode(&lengths), STANDARD.encode(&blocks));
    let binary = vti(zlib, IMAGE, &format!("{SCALARS} format=\"binary\""), &parts);
    mutate("a.vti", binary.as_bytes(), binary.len());
    let text = vti(zlib, IMAGE, &format!("{SCALARS} format=\"appended\" offset=\"0\""), "")
        .replace("</VTKFile>\n", "");
    let raw = [text.as_bytes(), b"<AppendedData encoding=\"raw\">_", &lengths, &blocks].concat();
    mutate("a.vti", &raw, raw.len());
}
