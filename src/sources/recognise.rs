//! What a file is, by how it begins: for those who are given a file and not told.

use super::{file, mesh_file, raw::GZIP_MAGIC, self_describing, slices};
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

/// Bytes of a file that are looked at.
const HEAD: u64 = 4096;

/// What can be shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Triangles.
    Mesh,
    /// Samples on a grid.
    Volume {
        /// Whether the file says how it lies in a patient.
        in_patient: bool,
    },
}

/// Endings of meshes and of volumes that are read: they count where the content says nothing, so that its reader says what is wrong.
const MESHES: [&str; 5] = ["obj", "ply", "stl", "gltf", "glb"];
const VOLUMES: [&str; 13] =
    ["nrrd", "nhdr", "nii", "hdr", "mha", "mhd", "dcm", "ima", "vtk", "vti", "tif", "tiff", "npy"];

/// What the file, or the folder of slices, is; none for what is neither, cannot be opened or is not there.
pub fn recognise(path: &Path) -> Option<Kind> {
    if path.is_dir() {
        // Slices of DICOM, unless it holds pictures only.
        return Some(Kind::Volume { in_patient: slices::pictures(path).is_none() });
    }
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ending == "ron" {
        return None;
    }
    let head = head(path)?;
    let stem = path.file_stem().map(Path::new).and_then(Path::extension);
    let stem = stem.map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let inner = if ending == "gz" { stem } else { ending };
    let by_name = || {
        if MESHES.contains(&inner.as_str()) {
            return Some(Kind::Mesh);
        }
        VOLUMES.contains(&inner.as_str()).then_some(Kind::Volume { in_patient: false })
    };
    let bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    if mesh_file::format_of_content(&head, bytes).is_some() {
        return Some(Kind::Mesh);
    }
    self_describing::in_patient(&head, &inner).map(|in_patient| Kind::Volume { in_patient }).or_else(by_name)
}

/// The first bytes of a file, unpacked if it is gzipped.
fn head(path: &Path) -> Option<Vec<u8>> {
    let (mut file, _) = file::open(path).ok()?;
    let packed = file::begins_with(path, &mut file, &GZIP_MAGIC).ok()?;
    let mut head = Vec::new();
    if packed {
        // As much as comes out of a stream that breaks.
        _ = MultiGzDecoder::new(file).take(HEAD).read_to_end(&mut head);
    } else {
        file.take(HEAD).read_to_end(&mut head).ok()?;
    }
    Some(head)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_how_they_begin() {
        let folder = tempfile::tempdir().unwrap();
        let recognised = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            recognise(&path)
        };
        let obj = b"# a comment\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let volume = Some(Kind::Volume { in_patient: false });
        let patient = Some(Kind::Volume { in_patient: true });
        assert_eq!(recognised("a.obj", obj), Some(Kind::Mesh));
        assert_eq!(recognised("model", obj), Some(Kind::Mesh));
        assert_eq!(recognised("a.ply", b"ply\nformat ascii 1.0\n"), Some(Kind::Mesh));
        assert_eq!(recognised("b", b"ply\r\nformat ascii 1.0\r\n"), Some(Kind::Mesh));
        assert_eq!(recognised("c", b"solid\nfacet normal 0 0 1\n"), Some(Kind::Mesh));
        let stl = [&[7; 80][..], &1_u32.to_le_bytes(), &[0; 50]].concat();
        assert_eq!((recognised("d", &stl), recognised("d", &stl[1..])), (Some(Kind::Mesh), None));
        assert_eq!(recognised("e", b"{ \"asset\": { \"version\": \"2.0\" } }"), Some(Kind::Mesh));
        assert_eq!(recognised("a.nrrd", b"NRRD0004\ntype: uchar\n"), volume);
        assert_eq!(recognised("b.nrrd", b"NRRD0004\nspace: left-posterior-superior\n"), patient);
        assert_eq!(recognised("a.vtk", b"# vtk DataFile Version 3.0\n"), volume);
        assert_eq!(recognised("f", b"II*\0\x08\0\0\0"), volume);
        assert_eq!(recognised("g", b"\x93NUMPY\x01\0"), volume);
        assert_eq!(recognised("h", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">"), volume);
        assert_eq!(recognised("i", b"<VTKFile type=\"UnstructuredGrid\">"), None);
        assert_eq!(recognised("empty.tiff", b""), volume);
        assert_eq!(recognised("empty.stl", b""), Some(Kind::Mesh));
        assert_eq!(recognised("notes.txt", b"v for victory\nno numbers\n"), None);
        assert_eq!(recognised("a.ron", b"v 0 0 0\n"), None);
        assert_eq!(recognised("scene", b"( entities: {} )"), None);
        assert_eq!(recognise(folder.path()), patient);
        assert_eq!(recognise(&folder.path().join("missing.obj")), None);
    }
}
