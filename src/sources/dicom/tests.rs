#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod folders;
mod frames;
mod masks_and_colours;
mod packed;
mod places;
mod values;

use std::io::Write;

use flate2::{Compression, write::DeflateEncoder};

use super::super::{
    Samples,
    self_describing::tests::{Folder, mutate, values},
};
use super::*;
use glam::Vec3;

const EXPLICIT: &str = "1.2.840.10008.1.2.1";
const IMPLICIT: &str = "1.2.840.10008.1.2";
const BIG: &str = "1.2.840.10008.1.2.2";
const DEFLATED: &str = "1.2.840.10008.1.2.1.99";
const RLE: &str = "1.2.840.10008.1.2.5";

/// A file of elements in the order they are added.
struct Dicom {
    syntax: &'static str,
    bytes: Vec<u8>,
}

impl Dicom {
    fn empty(syntax: &'static str) -> Self {
        Self { syntax, bytes: Vec::new() }
    }

    /// A slice of 3 x 2 pixels of 16 bits at z, in the series `uid`.
    fn slice(syntax: &'static str, z: f64, uid: &str) -> Self {
        let mut dicom = Self::empty(syntax);
        dicom.add(0x0018_0050, b"DS", b"2.5 ");
        dicom.add(0x0020_000e, b"UI", uid.as_bytes());
        dicom.add(0x0020_0013, b"IS", b"1 ");
        dicom.add(0x0020_0032, b"DS", format!("0\\0\\{z:.3}").as_bytes());
        dicom.add(0x0020_0037, b"DS", b"1\\0\\0\\0\\1\\0 ");
        dicom.image(b"0.5\\0.25", 16, 12, 0)
    }

    fn image(mut self, spacing: &[u8], bits: u16, stored: u16, signed: u16) -> Self {
        self.short(0x0028_0002, 1);
        self.short(0x0028_0010, 2);
        self.short(0x0028_0011, 3);
        self.add(0x0028_0030, b"DS", spacing);
        self.short(0x0028_0100, bits);
        self.short(0x0028_0101, stored);
        self.short(0x0028_0102, stored - 1);
        self.short(0x0028_0103, signed);
        self
    }

    fn number16(&self, number: u16) -> [u8; 2] {
        if self.syntax == BIG { number.to_be_bytes() } else { number.to_le_bytes() }
    }

    fn number32(&self, number: u32) -> [u8; 4] {
        if self.syntax == BIG { number.to_be_bytes() } else { number.to_le_bytes() }
    }

    fn short(&mut self, tag: u32, value: u16) {
        self.add(tag, b"US", &self.number16(value));
    }

    fn add(&mut self, tag: u32, vr: &[u8; 2], value: &[u8]) {
        self.begin(tag, vr, value.len() as u32);
        self.bytes.extend(value);
    }

    fn begin(&mut self, tag: u32, vr: &[u8; 2], length: u32) {
        let (group, element) = (self.number16((tag >> 16) as u16), self.number16(tag as u16));
        self.bytes.extend([group, element].concat());
        if self.syntax == IMPLICIT || tag >> 16 == 0xfffe {
            self.bytes.extend(self.number32(length));
        } else if matches!(vr, b"OW" | b"OB" | b"OV" | b"SQ" | b"UN") {
            self.bytes.extend([vr.as_slice(), &[0, 0], &self.number32(length)].concat());
        } else {
            self.bytes.extend([vr.as_slice(), &self.number16(length as u16)].concat());
        }
    }

    /// A sequence of items, each filled by one of the functions.
    fn sequence(&mut self, tag: u32, items: &[&dyn Fn(&mut Self)]) {
        self.begin(tag, b"SQ", u32::MAX);
        for fill in items {
            self.begin(0xfffe_e000, b"  ", u32::MAX);
            fill(self);
            self.begin(0xfffe_e00d, b"  ", 0);
        }
        self.begin(0xfffe_e0dd, b"  ", 0);
    }

    /// Text, padded to an even length.
    fn text(&mut self, tag: u32, vr: &[u8; 2], text: &str) {
        let padded = if text.len().is_multiple_of(2) { text.to_owned() } else { format!("{text} ") };
        self.add(tag, vr, padded.as_bytes());
    }

    /// Packed frames in items, behind a table of where they begin.
    fn items(mut self, table: &[u32], items: &[&[u8]]) -> Self {
        self.begin(0x7fe0_0010, b"OB", u32::MAX);
        self.add(
            0xfffe_e000,
            b"  ",
            &table.iter().flat_map(|place| place.to_le_bytes()).collect::<Vec<u8>>(),
        );
        for item in items {
            self.add(0xfffe_e000, b"  ", item);
        }
        self.begin(0xfffe_e0dd, b"  ", 0);
        self
    }

    fn pixels(mut self, pixels: &[u16]) -> Self {
        let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| self.number16(*pixel)).collect();
        self.add(0x7fe0_0010, b"OW", &bytes);
        self
    }

    fn file(&self) -> Vec<u8> {
        let mut meta = Self::empty(EXPLICIT);
        meta.add(0x0002_0010, b"UI", format!("{}\0", self.syntax).as_bytes());
        let mut body = self.bytes.clone();
        if self.syntax == DEFLATED {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(&body).unwrap();
            body = encoder.finish().unwrap();
        }
        [vec![0; 128], b"DICM".to_vec(), meta.bytes, body].concat()
    }
}

const PIXELS: [u16; 6] = [1, 2, 3, 4, 5, 6];
/// As they are with +x to the right and +y anterior.
const TURNED: [f32; 6] = [6.0, 5.0, 4.0, 3.0, 2.0, 1.0];

#[test]
fn one_slice_is_read_in_every_syntax() {
    let folder = Folder::new();
    for syntax in [EXPLICIT, IMPLICIT, BIG, DEFLATED] {
        let volume = folder.read("a.dcm", Dicom::slice(syntax, 0.0, "1").pixels(&PIXELS).file());
        assert_eq!((volume.size, volume.spacing), ([3, 2, 1], Vec3::new(0.25, 0.5, 2.5)), "{syntax}");
        assert_eq!(values(&volume), TURNED, "{syntax}");
        assert!(volume.notes[0].contains("left, posterior, superior"), "{:?}", volume.notes);
    }
    let mut runs = Dicom::slice(RLE, 0.0, "1");
    runs.begin(0x7fe0_0010, b"OB", u32::MAX);
    runs.add(0xfffe_e000, b"  ", &[]);
    // Two runs: six high bytes of 0, then the low bytes as they are.
    let mut frame = [2_u32, 64, 66].map(u32::to_le_bytes).concat();
    frame.resize(64, 0);
    frame.extend([251, 0, 5, 1, 2, 3, 4, 5, 6, 0]);
    runs.add(0xfffe_e000, b"  ", &frame);
    assert_eq!(values(&folder.read("a.dcm", runs.file())), TURNED);
}

#[test]
fn rescale_and_sign_apply_to_the_bits_that_are_stored() {
    let folder = Folder::new();
    let mut dicom = Dicom::empty(EXPLICIT).image(b"1\\1 ", 16, 12, 1);
    dicom.add(0x0028_1052, b"DS", b"-1000 ");
    dicom.add(0x0028_1053, b"DS", b"2 ");
    // 0x0fff is -1 in twelve bits; the four above it are none of its.
    let volume = folder.read("a.dcm", dicom.pixels(&[0x0fff, 0xf001, 0, 0, 0, 0]).file());
    assert_eq!(values(&volume)[..3], [-1002.0, -998.0, -1000.0]);
    let bytes = Dicom::empty(EXPLICIT).image(b"1\\1 ", 8, 8, 0).pixels(&[0x0201, 0x0403, 0x0605]);
    assert_eq!(folder.read("a.dcm", bytes.file()).samples, Samples::U8(vec![1, 2, 3, 4, 5, 6]));
    let big = Dicom::empty(BIG).image(b"1\\1 ", 8, 8, 0).pixels(&[0x0201, 0x0403, 0x0605]);
    assert_eq!(folder.read("a.dcm", big.file()).samples, Samples::U8(vec![1, 2, 3, 4, 5, 6]));
}

#[test]
fn a_folder_is_sorted_by_place_and_the_largest_series() {
    let folder = Folder::new();
    // Names, places and series in no order; and what is no slice.
    for (name, z, series, value) in
        [("c", 1.0, "7.7", 10), ("a", 3.0, "7.7", 30), ("b", 2.0, "7.7", 20), ("d", 9.0, "8.8", 99)]
    {
        folder.file(name, Dicom::slice(EXPLICIT, z, series).pixels(&[value; 6]).file());
    }
    folder.file("readme.txt", "no slice");
    folder.file("broken", &Dicom::slice(EXPLICIT, 4.0, "7.7").pixels(&PIXELS).file()[..300]);
    let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
    assert_eq!((volume.size, volume.spacing), ([3, 2, 3], Vec3::new(0.25, 0.5, 1.0)));
    assert_eq!([0, 1, 2].map(|z| volume.sample([0, 0, z]).unwrap()), [10.0, 20.0, 30.0]);
    let notes = volume.notes.join("\n");
    assert!(notes.contains("1 files that cannot be read are left out"), "{notes}");
    assert!(notes.contains("of 2 series only the largest is read"), "{notes}");
    folder.file("e", Dicom::slice(EXPLICIT, 5.0, "7.7").pixels(&[50; 6]).file());
    folder.file("f", Dicom::slice(EXPLICIT, 5.0, "7.7").pixels(&[51; 6]).file());
    let notes = read_folder(&folder.path(""), &Selection::default()).unwrap().notes.join("\n");
    assert!(notes.contains("1 slices at the place of another"), "{notes}");
    assert!(notes.contains("1.000 to 2.000 mm apart (are some missing?); 1.000 mm"), "{notes}");
}

#[test]
fn frames_of_one_file_get_their_places_from_its_sequences() {
    let folder = Folder::new();
    let mut dicom = Dicom::empty(EXPLICIT);
    dicom.add(0x0028_0008, b"IS", b"2 ");
    let mut dicom = dicom.image(b"1\\1 ", 16, 16, 0);
    dicom.begin(0x5200_9230, b"SQ", u32::MAX);
    for z in ["3", "1"] {
        dicom.begin(0xfffe_e000, b"  ", u32::MAX);
        dicom.begin(0x0020_9113, b"SQ", u32::MAX);
        dicom.begin(0xfffe_e000, b"  ", u32::MAX);
        dicom.add(0x0020_0032, b"DS", format!("0\\0\\{z} ").as_bytes());
        for end in [0xfffe_e00d, 0xfffe_e0dd, 0xfffe_e00d] {
            dicom.begin(end, b"  ", 0);
        }
    }
    dicom.begin(0xfffe_e0dd, b"  ", 0);
    let volume = folder.read("a.dcm", dicom.pixels(&[9, 9, 9, 9, 9, 9, 1, 2, 3, 4, 5, 6]).file());
    assert_eq!((volume.size, volume.spacing.z), ([3, 2, 2], 2.0));
    assert_eq!(values(&volume)[..6], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn what_is_wrong_is_told() {
    let folder = Folder::new();
    let refused = |dicom: &Dicom| folder.refusal("a.dcm", dicom.file());
    let xl = Dicom::slice("1.2.840.10008.1.2.4.110", 0.0, "1").items(&[], &[&[0; 64]]);
    assert!(
        refused(&xl).contains(
            "packed by JPEG XL Lossless (1.2.840.10008.1.2.4.110); unpack it with `dicom-transcode`"
        ),
        "{}",
        refused(&xl)
    );
    let short = Dicom::slice(EXPLICIT, 0.0, "1").pixels(&PIXELS[..5]);
    assert!(
        refused(&short).contains("10 bytes; 3 x 2 pixels of 2 bytes in 1 frames need 12"),
        "{}",
        refused(&short)
    );
    let cut = Dicom::slice(EXPLICIT, 0.0, "1").pixels(&PIXELS).file();
    assert!(folder.refusal("a.dcm", &cut[..cut.len() - 3]).contains("need 12"));
    assert!(refused(&Dicom::slice(EXPLICIT, 0.0, "1")).contains("without pixels"));
    let mut colours = Dicom::slice(EXPLICIT, 0.0, "1");
    colours.short(0x0028_0002, 4);
    colours.add(0x0028_0004, b"CS", b"CMYK");
    assert!(refused(&colours.pixels(&PIXELS)).contains("its pixels are 4 numbers of `CMYK`"));
    let bits = Dicom::empty(EXPLICIT).image(b"1\\1 ", 12, 12, 0).pixels(&PIXELS);
    assert!(refused(&bits).contains("its pixels have 12 bits"));
    let mut many = Dicom::slice(EXPLICIT, 0.0, "1");
    many.add(0x0028_0008, b"IS", b"60000 ");
    assert!(refused(&many.pixels(&PIXELS)).contains("fewer than expected"));
    let flat = Dicom::empty(EXPLICIT).image(b"0\\1 ", 16, 16, 0).pixels(&PIXELS);
    assert!(refused(&flat).contains("spacing 1 x 0 x 1"), "{}", refused(&flat));
}

#[test]
fn damaged_files_never_panic() {
    for syntax in [EXPLICIT, IMPLICIT, BIG, DEFLATED] {
        let file = Dicom::slice(syntax, 0.0, "1").pixels(&PIXELS).file();
        mutate("a.dcm", &file, file.len());
    }
    let mut runs = Dicom::slice(RLE, 0.0, "1");
    runs.begin(0x7fe0_0010, b"OB", u32::MAX);
    runs.add(0xfffe_e000, b"  ", &[]);
    runs.add(0xfffe_e000, b"  ", &[2; 80]);
    mutate("a.dcm", &runs.file(), 1000);
}

/// Elements that nest without an end are no recursion and no endless loop.
#[test]
fn endless_nesting_is_refused() {
    let folder = Folder::new();
    let mut dicom = Dicom::empty(EXPLICIT);
    for _ in 0..100_000 {
        dicom.begin(0x0040_0275, b"SQ", u32::MAX);
        dicom.begin(0xfffe_e000, b"  ", u32::MAX);
    }
    assert!(folder.refusal("a.dcm", dicom.file()).contains("too deep"));
}
