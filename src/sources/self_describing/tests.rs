#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{io::Write, path::PathBuf};

use flate2::{Compression, write::GzEncoder, write::ZlibEncoder};
use glam::DVec3;
use tempfile::TempDir;

use super::*;

/// A folder with files that are made on the spot.
pub(in crate::sources) struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }

    /// What a file of these bytes is read as.
    pub fn read(&self, name: &str, bytes: impl AsRef<[u8]>) -> VolumeData {
        read_volume(&self.file(name, bytes), &Selection::default()).unwrap()
    }

    /// What is read of it if one of several is chosen.
    pub fn chosen(
        &self,
        name: &str,
        bytes: impl AsRef<[u8]>,
        index: u32,
        component: Option<u32>,
    ) -> Result<VolumeData, String> {
        let selection = Selection { index, component, ..Selection::default() };
        read_volume(&self.file(name, bytes), &selection).map_err(|error| error.to_string())
    }

    /// What a file of these bytes is refused with, without the folder.
    pub fn refusal(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        self.refused(&self.file(name, bytes))
    }

    pub fn refused(&self, path: &Path) -> String {
        let text = read_volume(path, &Selection::default()).unwrap_err().to_string();
        text.replace(&format!("{}/", self.0.path().display()), "")
    }
}

pub(in crate::sources) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

pub(in crate::sources) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// All samples of a volume.
pub(in crate::sources) fn values(volume: &VolumeData) -> Vec<f32> {
    (0..volume.samples.len()).map(|index| volume.samples.get(index).unwrap()).collect()
}

/// Where the centre of a voxel lies in the world of the file, mm.
pub(in crate::sources) fn place_of(volume: &VolumeData, voxel: [u32; 3]) -> DVec3 {
    let steps = DVec3::from(voxel.map(f64::from)) * volume.spacing.as_dvec3();
    let [x, y, z] = volume.frame.directions;
    volume.frame.origin + x * steps.x + y * steps.y + z * steps.z
}

/// Whether two places are the same to a hundredth of a micrometre.
pub(in crate::sources) fn is_at(place: DVec3, expected: [f64; 3]) -> bool {
    place.distance(DVec3::from(expected)) < 1e-5
}

/// Reads a file with its first `header` bytes damaged in 2,000 ways: it must end, and not by a panic.
pub(in crate::sources) fn mutate(name: &str, bytes: &[u8], header: usize) {
    let folder = Folder::new();
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 33) as usize % below
    };
    let words: [&[u8]; 8] = [
        b"999999999",
        b"-1",
        b"nan",
        b"1e308",
        b"\xff\xff\xff\xff",
        b"\0\0\0\0",
        b"\x7f\xff",
        b"18446744073709551615",
    ];
    for _ in 0..2000 {
        let mut damaged = bytes.to_vec();
        for _ in 0..=random(3) {
            let at = random(header.min(damaged.len()).max(1));
            match random(5) {
                0 => damaged[at] = random(256) as u8,
                1 => damaged[at] ^= 1 << random(8),
                2 => drop(damaged.drain(at..(at + 1 + random(8)).min(damaged.len()))),
                3 => damaged.truncate(at),
                _ => {
                    let word = words[random(words.len())];
                    let end = (at + word.len()).min(damaged.len());
                    damaged.splice(at..end, word.iter().copied());
                }
            }
            if damaged.is_empty() {
                break;
            }
        }
        let path = folder.file(name, &damaged);
        let start = std::time::Instant::now();
        let read = read_volume(&path, &Selection::default());
        assert!(start.elapsed().as_secs() < 10, "{:?}", String::from_utf8_lossy(&damaged));
        if let Ok(volume) = read {
            assert!(volume.samples.as_bytes().len() <= 1100 * bytes.len());
        }
    }
}

#[test]
fn what_is_no_volume_is_told_so_by_name() {
    let folder = Folder::new();
    assert!(
        folder
            .refusal("a.raw", [1, 2, 3])
            .starts_with("a.raw: bare samples do not say what they are; write `Volume: Raw(")
    );
    folder.file("b.mhd", "");
    assert!(folder.refusal("b.raw", [1, 2, 3]).contains("name their header, b.mhd"));
    assert!(folder.refusal("a.vti", "nothing").contains("it has no element `<VTKFile`"));
    assert!(folder.refusal("a.nrrd", "abc").contains("it does not begin with `NRRD`"));
    assert!(folder.refusal("a.gz", gzip(b"abc")).contains("what it unpacks to is not NIfTI"));
    let nothing = folder.refusal("a.xyz", "abc");
    assert!(
        nothing.starts_with(
            "a.xyz: neither its content nor its name is of a format of volumes; read are NRRD, NIfTI"
        ),
        "{nothing}"
    );
    for (name, bytes, part) in [
        ("a.nrrd", b"\x89PNG\r\n\x1a\n".as_slice(), "a single picture; name the folder of all slices"),
        ("a.npz", b"PK\x03\x04", "an archive of NumPy arrays; unpack it with `unzip`"),
        ("a.zip", b"PK\x03\x04", "an archive; unpack it"),
        ("a.h5", b"\x89HDF\r\n\x1a\n", "HDF5"),
        ("a.mhd", b"\xff\xfeN\0D\0", "text of UTF-16; convert it: iconv"),
        ("nothing", b"", "the file is empty"),
    ] {
        let text = folder.refusal(name, bytes);
        // Two lines: what it seems to be, and what is read.
        assert!(text.contains(part) && text.lines().count() == 2, "{text}");
    }
    assert!(folder.refusal("b.nrrd", gzip(b"NRRD0004\n")).contains("unpack it with `gunzip`"));
    let mut analyze = vec![0; 348];
    analyze[..4].copy_from_slice(&348_i32.to_le_bytes());
    assert!(folder.refusal("a.hdr", analyze).contains("ANALYZE 7.5"));
    assert!(folder.refused(&folder.path("none.nrrd")).contains("no such file"));
    assert!(folder.refused(folder.0.path()).contains("a folder without DICOM slices"));
}
