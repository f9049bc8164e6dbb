//! Files that are sound, to begin with: one of each kind that is read, made here, and what `TYNDALL_DATA` and the repository have.

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fs;
use std::io::Write;
use std::path::Path;

/// A file, and what it names.
#[derive(Clone, Debug)]
pub struct Seed {
    pub name: String,
    pub bytes: Vec<u8>,
    pub beside: Vec<(String, Vec<u8>)>,
}

/// The longest file that is mutated.
const LONGEST: u64 = 40_000;

/// All seeds, always in the same order.
pub fn all() -> Result<Vec<Seed>> {
    let mut seeds = made();
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for folder in ["scenes", "assets", "tests/bad_scenes"] {
        found(&repository.join(folder), &mut seeds)?;
    }
    if let Some(data) = std::env::var_os("TYNDALL_DATA") {
        found(Path::new(&data), &mut seeds)?;
        found(&Path::new(&data).join("../reported"), &mut seeds)?;
    }
    Ok(seeds)
}

/// Adds the small files of a folder and of those below it.
fn found(folder: &Path, seeds: &mut Vec<Seed>) -> Result<()> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    let mut paths: Vec<_> = entries.filter_map(Result::ok).map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            found(&path, seeds)?;
            continue;
        }
        let is_small = path.metadata().is_ok_and(|metadata| metadata.is_file() && metadata.len() <= LONGEST);
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if !is_small || ["txt", "md", "py", "png", "raw", "sh", "json"].contains(&ending.as_str()) {
            continue;
        }
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        seeds.push(Seed { name, bytes, beside: Vec::new() });
    }
    Ok(())
}

/// One file of each kind.
fn made() -> Vec<Seed> {
    let alone = |name: &str, bytes: Vec<u8>| Seed { name: name.to_owned(), bytes, beside: Vec::new() };
    let samples: Vec<u8> = (0..120).map(|index| (index * 7 % 251) as u8).collect();
    let with = |name: &str, header: &str, data: &str| Seed {
        name: name.to_owned(),
        bytes: header.as_bytes().to_vec(),
        beside: vec![(data.to_owned(), samples.clone())],
    };
    let and = |header: &str, data: &[u8]| [header.as_bytes(), data].concat();
    vec![
        alone("a.obj", OBJ.into()),
        Seed {
            beside: vec![("a.mtl".into(), MTL.into())],
            ..alone("b.obj", format!("mtllib a.mtl\nusemtl red\n{OBJ}").into())
        },
        alone("a.ply", PLY.into()),
        alone("b.ply", binary_ply()),
        alone("a.stl", STL.into()),
        alone("b.stl", binary_stl()),
        alone("a.gltf", gltf().into()),
        alone("a.glb", glb()),
        alone("a.nrrd", and(NRRD, &samples)),
        alone("list.nrrd", and(NRRD_LIST, &samples)),
        alone("packed.nrrd", and(&NRRD.replace("raw", "gzip"), &gzip(&samples))),
        with("a.nhdr", &NRRD.replace("\n\n", "\ndata file: a.raw\n"), "a.raw"),
        alone("a.nii", nifti(&samples)),
        alone("a.nii.gz", gzip(&nifti(&samples))),
        alone("a.mha", and(&META_IMAGE.replace("a.raw", "LOCAL"), &samples)),
        with("a.mhd", META_IMAGE, "a.raw"),
        alone("a.vtk", and(VTK, &samples)),
        alone("b.vtk", VTK_TEXT.into()),
        alone("a.vti", VTI.into()),
        alone("a.npy", npy(&samples)),
        alone("a.tif", tiff(&samples)),
        alone("a.dcm", dicom(&samples)),
        alone("a.ron", SCENE.into()),
    ]
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    // Writing to memory does not fail.
    _ = packed.write_all(bytes);
    packed.finish().unwrap_or_default()
}

const OBJ: &str = "# a tetrahedron\no a\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 -1\ns 1\n\
    f 1/1/1 3/3/1 2/2/1\nf 1 2 4\ns off\nf 1 4 3\nf -3// -2// -1//\nl 1 2\np 1\n";
const MTL: &str = "newmtl red\nKd 1 0 0\nKs 0.1 0.1 0.1\nNs 20\nd 0.5\nillum 2\nmap_Kd -s 2 2 1 none.png\n";
const PLY: &str = "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n0 0 1 9 9 9\n3 0 2 1\n3 0 1 3\n4 0 3 2 1\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const NRRD: &str = "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 6 5 4\nspace: left-posterior-superior\n\
    space directions: (1,0,0) (0,1,0.1) (0,0,2)\nspace origin: (1,2,3)\nencoding: raw\n\n";
const NRRD_LIST: &str = "NRRD0005\ntype: uint16\nendian: big\ndimension: 4\nsizes: 2 5 3 2\nkinds: list domain domain domain\n\
    spacings: nan 1 2 3\nlabels: \"t\" \"x\" \"y\" \"z\"\nencoding: raw\n\n";
const META_IMAGE: &str = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n\
    Offset = 1 2 3\nElementSpacing = 1 1 2\nDimSize = 6 5 4\nElementType = MET_UCHAR\nElementDataFile = a.raw\n";
const VTK: &str = "# vtk DataFile Version 3.0\na\nBINARY\nDATASET STRUCTURED_POINTS\nFIELD FieldData 1\nTIME 1 1 int\n\0\0\0\x01\n\
    DIMENSIONS 6 5 4\nORIGIN 0 0 0\nSPACING 1 1 2\nPOINT_DATA 120\nSCALARS a unsigned_char 1\nLOOKUP_TABLE default\n";
const VTK_TEXT: &str = "# vtk DataFile Version 3.0\na\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\nX_COORDINATES 2 float\n0 1\n\
    Y_COORDINATES 2 float\n0 1\nZ_COORDINATES 2 float\n0 2\nCELL_DATA 1\nSCALARS c float\nLOOKUP_TABLE default\n1.5\n\
    POINT_DATA 8\nVECTORS v float\n0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1\nSCALARS a short 1\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\n";
const VTI: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n\
    <ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 2\">\n<Piece Extent=\"0 1 0 1 0 1\">\n<PointData Scalars=\"a\">\n\
    <DataArray type=\"Float32\" Name=\"a\" format=\"ascii\">\n1 2 3 4 5 6 7 8\n</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n";
const SCENE: &str = "#![enable(implicit_some)]\n// a scene\n(\n    millimetres_per_unit: 10.0,\n    background: (0.1, 0.1, 0.1),\n    entities: {\n        \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 5.0), projection: Perspective(vertical_fov: 30.0)) ),\n        \"sun\": ( DirectionalLight: (direction: (-1.0, -1.0, -1.0), irradiance: (1.0, 1.0, 1.0)) ),\n        \"ball\": (\n            Transform: (translation: (1.0, 0.0, 0.0), scale: 2.0),\n            Mesh: Sphere(radius: 1.0, subdivisions: 2),\n            Subsurface: (material: Preset(\"marble\"), specular: Some((strength: 0.2))),\n            ScatteringMaps: (strategy: Adaptive, samples: 20),\n        ),\n        \"cloud\": (\n            Volume: Raw(path: \"a.raw\", size: (6, 5, 4)),\n            TransferFunction: (domain: (0.0, 255.0), points: [(0.0, (1.0, 0.5, 0.2), 0.0), (1.0, (1.0, 1.0, 1.0), 0.8)]),\n            VolumeLighting: LightVolume(resolution: 0.5),\n        ),\n    },\n)\n";

fn binary_ply() -> Vec<u8> {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\n\
        element face 1\nproperty list uchar uint vertex_indices\nend_header\n";
    let mut bytes = header.as_bytes().to_vec();
    for [x, y] in [[0.0f32, 0.0], [1.0, 0.0], [0.0, 1.0]] {
        bytes.extend([x.to_le_bytes(), y.to_le_bytes()].concat());
        bytes.extend(0.5f64.to_le_bytes());
    }
    bytes.push(3);
    bytes.extend([0u32, 1, 2].map(u32::to_le_bytes).concat());
    bytes
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(2u32.to_le_bytes());
    for [a, b] in [[1.0f32, 0.0], [0.0, 1.0]] {
        let numbers = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, a, b, 0.0, b, -a, 0.0];
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Three positions and three indices.
fn triangle() -> Vec<u8> {
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes = positions.map(f32::to_le_bytes).concat();
    bytes.extend([0u16, 1, 2, 0].map(u16::to_le_bytes).concat());
    bytes
}

fn gltf() -> String {
    let uri = format!(", \"uri\": \"data:application/octet-stream;base64,{}\"", STANDARD.encode(triangle()));
    document(&uri)
}

fn glb() -> Vec<u8> {
    let mut text = document("").into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary = triangle();
    let chunk =
        |kind: &[u8; 4], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes()[..], kind, bytes].concat();
    let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &binary)].concat();
    [b"glTF".as_slice(), &2u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

fn document(uri: &str) -> String {
    format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"scene\": 0, \"scenes\": [{{\"nodes\": [0]}}],\n\"nodes\": [{{\"mesh\": 0, \"scale\": [1, 2, 1]}}],\n\
         \"materials\": [{{\"pbrMetallicRoughness\": {{\"baseColorFactor\": [1, 0, 0, 1]}}}}],\n\
         \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0}}, \"indices\": 1, \"material\": 0}}]}}],\n\
         \"accessors\": [{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\", \"min\": [0, 0, 0], \"max\": [1, 1, 0]}},\n\
         {{\"bufferView\": 1, \"componentType\": 5123, \"count\": 3, \"type\": \"SCALAR\"}}],\n\
         \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": 36}}, {{\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 6}}],\n\
         \"buffers\": [{{\"byteLength\": 44{uri}}}]}}"
    )
}

fn nifti(samples: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; 352];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &348u32.to_le_bytes());
    put(40, &[3i16, 6, 5, 4, 1, 1, 1, 1].map(i16::to_le_bytes).concat());
    put(70, &[2i16, 8].map(i16::to_le_bytes).concat());
    put(76, &[1.0f32, 1.0, 1.0, 2.0, 1.0].map(f32::to_le_bytes).concat());
    put(108, &352.0f32.to_le_bytes());
    put(112, &[1.0f32, 0.0].map(f32::to_le_bytes).concat());
    put(252, &[1i16, 1].map(i16::to_le_bytes).concat());
    put(280, &[1.0f32, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 6.0, 0.0, 0.0, 2.0, 7.0].map(f32::to_le_bytes).concat());
    put(344, b"n+1\0");
    [&bytes, samples].concat()
}

fn npy(samples: &[u8]) -> Vec<u8> {
    let mut header = "{'descr': '|u1', 'fortran_order': False, 'shape': (4, 5, 6), }".to_owned();
    header.push_str(&" ".repeat(127 - 10 - header.len()));
    header.push('\n');
    [b"\x93NUMPY\x01\0".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes(), samples].concat()
}

/// Two pages of 10 x 6 samples.
fn tiff(samples: &[u8]) -> Vec<u8> {
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    for page in 0..2u32 {
        let entries: [(u16, u16, u32); 8] = [
            (256, 3, 10),
            (257, 3, 6),
            (258, 3, 8),
            (259, 3, 1),
            (262, 3, 1),
            (273, 4, 0),
            (278, 3, 6),
            (279, 4, 60),
        ];
        let start = bytes.len() as u32;
        let end = start + 2 + 12 * entries.len() as u32 + 4;
        bytes.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, value) in entries {
            let value = if tag == 273 { end } else { value };
            bytes.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
            bytes.extend([1, value].map(u32::to_le_bytes).concat());
        }
        bytes.extend(if page == 0 { end + 60 } else { 0 }.to_le_bytes());
        let first = 60 * page as usize;
        bytes.extend(&samples[first..first + 60]);
    }
    bytes
}

/// One slice of 12 x 10 samples, explicit VR, little endian.
fn dicom(samples: &[u8]) -> Vec<u8> {
    let element = |group: u16, element: u16, vr: &[u8; 2], value: &[u8]| {
        let mut bytes = [group.to_le_bytes(), element.to_le_bytes(), *vr].concat();
        match vr {
            b"OB" | b"OW" => bytes.extend([&[0, 0], &(value.len() as u32).to_le_bytes()[..]].concat()),
            _ => bytes.extend((value.len() as u16).to_le_bytes()),
        }
        bytes.extend(value);
        bytes
    };
    let number = |value: u16| value.to_le_bytes();
    let syntax = element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1\0");
    let length = element(2, 0, b"UL", &(syntax.len() as u32).to_le_bytes());
    let data = [
        element(8, 0x60, b"CS", b"CT"),
        element(0x18, 0x50, b"DS", b"2.0 "),
        element(0x20, 0xe, b"UI", b"1.2.3\0"),
        element(0x20, 0x13, b"IS", b"1 "),
        element(0x20, 0x32, b"DS", b"0\\0\\0 "),
        element(0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0 "),
        element(0x28, 2, b"US", &number(1)),
        element(0x28, 4, b"CS", b"MONOCHROME2 "),
        element(0x28, 0x10, b"US", &number(10)),
        element(0x28, 0x11, b"US", &number(12)),
        element(0x28, 0x30, b"DS", b"1\\1 "),
        element(0x28, 0x100, b"US", &number(8)),
        element(0x28, 0x101, b"US", &number(8)),
        element(0x28, 0x102, b"US", &number(7)),
        element(0x28, 0x103, b"US", &number(0)),
        element(0x28, 0x1052, b"DS", b"-100"),
        element(0x28, 0x1053, b"DS", b"2 "),
        element(0x7fe0, 0x10, b"OB", samples),
    ];
    [vec![0; 128], b"DICM".to_vec(), length, syntax, data.concat()].concat()
}
