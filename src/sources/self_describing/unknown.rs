//! What a file seems to be that no reader of volumes knows, and what is read in its place.

use std::path::Path;

use super::{SourceError, nifti};

/// The formats that are read, for who has another.
const READ: &str = "read are NRRD, NIfTI, MetaImage, DICOM, VTK images (.vtk, .vti), TIFF stacks, NumPy arrays (.npy), folders of numbered pictures, \
     and bare samples by `Volume: Raw(path: …, size: …, format: …)`";

/// What is told of it: what it seems to be, by its content first, and, on a line of its own, what is read; else what a header beside it or
/// its name says.
pub(super) fn unknown(path: &Path, head: &[u8], ending: &str) -> SourceError {
    let header = ["mhd", "nhdr"]
        .map(|ending| path.with_extension(ending))
        .into_iter()
        .find(|header| header != path && header.is_file());
    let (found, mend) = match (by_content(head, ending), header) {
        (Some((found, mend)), _) => (found, format!("{mend};\n{READ}")),
        (None, Some(header)) => {
            ("bare samples do not say what they are", format!("name their header, {}", header.display()))
        }
        (None, None) => {
            let (found, mend) = by_name(ending);
            (found, mend.unwrap_or(READ).to_owned())
        }
    };
    SourceError::Unsupported { path: path.to_owned(), found: found.to_owned(), mend }
}

/// What the first bytes of a file say that it is, and what to do with it.
fn by_content(head: &[u8], ending: &str) -> Option<(&'static str, &'static str)> {
    let begins = |magic: &[u8]| head.starts_with(magic);
    let at = |place: usize, magic: &[u8]| head.get(place..place + magic.len()) == Some(magic);
    Some(if head.is_empty() {
        ("the file is empty", "fetch or export it again")
    } else if nifti::is_analyze(head) {
        ("its header is of ANALYZE 7.5, which does not say which side is left", "convert it to NIfTI")
    } else if begins(b"\xff\xfe") || begins(b"\xfe\xff") {
        ("it seems to be text of UTF-16", "convert it: iconv -f UTF-16 -t UTF-8 IN > OUT")
    } else if begins(b"\x89PNG")
        || begins(b"\xff\xd8\xff")
        || begins(b"GIF8")
        || begins(b"BM") && at(6, &[0; 4])
    {
        ("it seems to be a single picture", "name the folder of all slices")
    } else if begins(b"PK\x03\x04") && ending == "npz" {
        (
            "it seems to be an archive of NumPy arrays",
            "unpack it with `unzip`, and name one of the .npy files in it",
        )
    } else if begins(b"PK\x03\x04") || begins(b"7z\xbc\xaf") || begins(b"Rar!") || at(257, b"ustar") {
        ("it seems to be an archive", "unpack it, and name a file or folder in it")
    } else if begins(b"BZh") || begins(b"\xfd7zXZ") || begins(&[0x28, 0xb5, 0x2f, 0xfd]) {
        ("it is packed by bzip2, xz or zstd", "unpack it")
    } else if begins(b"\x89HDF\r\n\x1a\n") || begins(b"CDF\x01") || begins(b"CDF\x02") {
        ("it seems to be HDF5 or NetCDF (Imaris, MINC, ilastik)", "export the data set as NRRD, TIFF or .npy")
    } else if begins(b"MATLAB 5.0") {
        ("it seems to be of MATLAB", "write the array as NIfTI (`niftiwrite`) or TIFF")
    } else if at(0, b" BDV") {
        ("it seems to be OpenVDB", "resample it to a dense grid, and export that as NRRD or VTK")
    } else if begins(b"SIMPLE  =") {
        ("it seems to be FITS", "convert it to .npy, of the array of its primary unit")
    } else if at(208, b"MAP ") {
        ("it seems to be MRC or CCP4, of electron microscopy", "convert it to TIFF or NRRD")
    } else if begins(b"# AmiraMesh") || begins(b"# Avizo") {
        ("it seems to be of Amira or Avizo", "export it as NRRD or TIFF")
    } else if begins(b"%PDF") {
        ("it seems to be a document, PDF", "name the data themselves")
    } else if begins(b"\x7fELF") || begins(b"MZ") {
        ("it seems to be a program", "name the data themselves")
    } else {
        return None;
    })
}

/// What the ending of a name says.
fn by_name(ending: &str) -> (&'static str, Option<&'static str>) {
    let again = Some("fetch or export it again");
    match ending {
        "nrrd" | "nhdr" => ("it does not begin with `NRRD`", again),
        "nii" | "hdr" => ("its header has no mark of NIfTI", again),
        "mha" | "mhd" => ("it has no line such as `NDims = 3`", again),
        "dcm" | "ima" => ("it is no DICOM: nothing in it begins like its elements", again),
        "vtk" => ("it does not begin with `# vtk DataFile`", again),
        "vti" => ("it has no element `<VTKFile`", again),
        "npy" => ("it does not begin like an array of NumPy", again),
        "tif" | "tiff" => ("it does not begin with the mark of TIFF", again),
        "raw" | "img" | "bin" | "dat" => (
            "bare samples do not say what they are",
            Some("write `Volume: Raw(path: …, size: …, format: …)`"),
        ),
        "slc" => ("SLC volumes are not read", Some("convert it to NRRD or MetaImage")),
        "gz" => (
            "what it unpacks to is not NIfTI",
            Some(
                "unpack it with `gunzip`, or for bare samples write `Volume: Raw(path: …, size: …, format: …)`",
            ),
        ),
        "obj" | "ply" | "stl" | "gltf" | "glb" => ("it seems to be a mesh", Some("write `Mesh: File(…)`")),
        _ => ("neither its content nor its name is of a format of volumes", None),
    }
}
