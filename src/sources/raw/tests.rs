#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{fs, io::Write, path::PathBuf};

use flate2::{Compression, write::GzEncoder};
use tempfile::TempDir;

use super::*;
use crate::sources::Samples;

fn layout(size: [u32; 3], format: SampleFormat) -> RawLayout {
    RawLayout { size, format, endian: Endian::Little, spacing: Vec3::ONE, skip_bytes: 0 }
}

fn write(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The error's text without the folder.
fn message(path: &Path, layout: &RawLayout) -> String {
    let text = read_raw(path, layout).unwrap_err().to_string();
    text.replace(&format!("{}/", path.parent().unwrap().display()), "")
}

#[test]
fn every_format_is_read_in_both_byte_orders() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(&folder, "a.raw", &[1, 2, 0xc3, 0x84]);
    let read = |size, format, endian| {
        let samples = read_raw(&path, &RawLayout { endian, ..layout(size, format) }).unwrap().samples;
        (0..samples.len()).map(|index| samples.get(index).unwrap()).collect::<Vec<_>>()
    };
    let (little, big) = (Endian::Little, Endian::Big);
    assert_eq!(read([4, 1, 1], SampleFormat::U8, big), [1.0, 2.0, 195.0, 132.0]);
    assert_eq!(read([1, 4, 1], SampleFormat::I8, little), [1.0, 2.0, -61.0, -124.0]);
    assert_eq!(read([2, 1, 1], SampleFormat::U16, little), [513.0, 33987.0]);
    assert_eq!(read([2, 1, 1], SampleFormat::U16, big), [258.0, 50052.0]);
    assert_eq!(read([2, 1, 1], SampleFormat::I16, big), [258.0, -15484.0]);
    assert_eq!(read([1, 1, 1], SampleFormat::F32, big), [f32::from_be_bytes([1, 2, 0xc3, 0x84])]);
    assert_eq!(read([1, 1, 1], SampleFormat::F32, little), [f32::from_le_bytes([1, 2, 0xc3, 0x84])]);
}

#[test]
fn a_header_is_skipped_and_a_packed_file_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = (0..=255).cycle().take(3 + 70 * 60 * 50).collect();
    let layout = RawLayout { skip_bytes: 3, ..layout([70, 60, 50], SampleFormat::U8) };
    let plain = read_raw(&write(&folder, "a.raw", &bytes), &layout).unwrap();
    let packed = read_raw(&write(&folder, "a.raw.GZ", &gzip(&bytes)), &layout).unwrap();
    assert_eq!(plain, packed);
    assert_eq!(plain.sample([0, 0, 0]), Some(3.0));
    // Two streams one after the other are one file: pigz and bgzip write such.
    let two = [gzip(&bytes[..1000]), gzip(&bytes[1000..])].concat();
    assert_eq!(read_raw(&write(&folder, "b.gz", &two), &layout).unwrap(), plain);
}

#[test]
fn a_wrong_length_says_by_how_much_and_what_to_try() {
    let folder = tempfile::tempdir().unwrap();
    let short = write(&folder, "bonsai.raw", &vec![0; 262_143]);
    assert_eq!(
        message(&short, &layout([64; 3], SampleFormat::U8)),
        "bonsai.raw: 262143 bytes; 64 x 64 x 64 U8 voxels need 262144 \
         (1 fewer than expected: is the size, format or skip_bytes wrong?)"
    );
    let long = write(&folder, "long.raw", &[0; 20]);
    let text = message(&long, &RawLayout { skip_bytes: 5, ..layout([2, 2, 1], SampleFormat::U16) });
    assert!(text.contains("2 x 2 x 1 U16 voxels after 5 skipped bytes need 13 (7 more than"), "{text}");
    assert!(text.contains("set skip_bytes to 12"), "{text}");
}

#[test]
fn a_packed_file_of_wrong_length_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cube = layout([4; 3], SampleFormat::U8);
    let text = message(&write(&folder, "a.gz", &gzip(&[0; 60])), &cube);
    assert!(text.contains("60 unpacked bytes; 4 x 4 x 4 U8 voxels need 64 (4 fewer"), "{text}");
    let text = message(&write(&folder, "b.gz", &gzip(&[0; 70])), &cube);
    assert!(text.contains("70 unpacked bytes") && text.contains("set skip_bytes to 6"), "{text}");
    let text = message(&write(&folder, "c.gz", &gzip(&vec![0; 3 << 20])), &cube);
    assert!(text.contains("at least 1048640 unpacked bytes"), "{text}");
    let text = message(&write(&folder, "d.gz", &gzip(&[0; 4])), &RawLayout { skip_bytes: 10, ..cube });
    assert!(text.contains("4 unpacked bytes") && text.contains("70 fewer"), "{text}");
    // 8 GiB announced, 4 bytes there: memory follows what arrives.
    let huge = layout([2048, 2048, 2048], SampleFormat::U8);
    assert!(message(&folder.path().join("d.gz"), &huge).contains("fewer than expected"));
}

#[test]
fn a_corrupt_packed_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let cube = layout([16; 3], SampleFormat::U8);
    let bytes: Vec<u8> = (0..4096_u32).map(|n| ((n * n) >> 3) as u8).collect();
    let whole = gzip(&bytes);
    let text = message(&write(&folder, "cut.gz", &whole[..whole.len() / 2]), &cube);
    assert!(text.contains("ends too early") && text.contains("fetch or pack it again"), "{text}");
    let text = message(&write(&folder, "tail.gz", &whole[..whole.len() - 3]), &cube);
    assert!(text.contains("ends too early after 4096 unpacked bytes"), "{text}");
    let text = message(&write(&folder, "garbage.gz", &[&whole[..], b"garbage after it"].concat()), &cube);
    assert!(text.contains("checksum or trailing bytes are wrong"), "{text}");
    let mut flipped = whole;
    *flipped.iter_mut().rev().nth(5).unwrap() ^= 1;
    let text = message(&write(&folder, "sum.gz", &flipped), &cube);
    assert!(text.contains("checksum or trailing bytes are wrong"), "{text}");
    let text = message(&write(&folder, "head.gz", &[0x1f, 0x8b, 99, 0, 0, 0, 0, 0, 0, 0, 0, 0]), &cube);
    assert!(text.contains("is corrupt"), "{text}");
}

#[test]
fn gzip_needs_both_its_name_and_its_magic() {
    let folder = tempfile::tempdir().unwrap();
    let cube = layout([4; 3], SampleFormat::U8);
    let text = message(&write(&folder, "a.raw", &gzip(&[0; 64])), &cube);
    assert!(text.contains("if it is one, name it .gz"), "{text}");
    let text = message(&write(&folder, "b.gz", &[0; 63]), &cube);
    assert!(text.contains("does not begin like a gzip file"), "{text}");
    let begins_alike = write(&folder, "c.raw", &[&GZIP_MAGIC[..], &[0; 62]].concat());
    assert_eq!(read_raw(&begins_alike, &cube).unwrap().range, (0.0, 139.0));
}

#[test]
fn a_path_that_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "Engine.raw", &[0]);
    let cube = layout([1; 3], SampleFormat::U8);
    assert_eq!(
        message(&folder.path().join("engin.raw"), &cube),
        "engin.raw: no such file; did you mean `Engine.raw`?"
    );
    let text = message(&folder.path().join("quite_different"), &cube);
    assert_eq!(text, "quite_different: no such file; check the path and the folder it is relative to");
    let text = read_raw(folder.path(), &cube).unwrap_err().to_string();
    assert!(text.ends_with("expected a file, found a folder; name a file"), "{text}");
}

#[test]
fn an_impossible_layout_is_refused_before_the_file_is_touched() {
    let nowhere = Path::new("nowhere.raw");
    let cube = layout([1; 3], SampleFormat::F32);
    let text = |layout: &RawLayout| read_raw(nowhere, layout).unwrap_err().to_string();
    assert!(
        text(&RawLayout { size: [1, 0, 1], ..cube }).starts_with("nowhere.raw: size 1 x 0 x 1: every side")
    );
    assert!(text(&RawLayout { size: [u32::MAX; 3], ..cube }).contains("exceed the limit"));
    assert!(text(&RawLayout { size: [2048, 2048, 513], ..cube }).contains("exceed the limit"));
    assert!(text(&RawLayout { spacing: Vec3::ZERO, ..cube }).contains("spacing 0 x 0 x 0 mm"));
    assert!(
        text(&RawLayout { skip_bytes: u64::MAX, ..cube }).contains("skip_bytes 18446744073709551615 exceeds")
    );
}

#[test]
fn what_is_skipped_of_a_plain_file_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.raw");
    let mut file = fs::File::create(&path).unwrap();
    // A file with a hole: reading through it would take minutes.
    let skip_bytes = 1 << 32;
    file.set_len(skip_bytes).unwrap();
    std::io::Seek::seek(&mut file, std::io::SeekFrom::End(0)).unwrap();
    file.write_all(&[1, 2, 3]).unwrap();
    let start = std::time::Instant::now();
    let layout = RawLayout { skip_bytes, ..layout([3, 1, 1], SampleFormat::U8) };
    assert_eq!(read_raw(&path, &layout).unwrap().samples, Samples::U8(vec![1, 2, 3]));
    assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    let text = message(&path, &RawLayout { skip_bytes: skip_bytes + 1, ..layout });
    assert!(text.contains("voxels after 4294967297 skipped bytes need 4294967300 (1 fewer"), "{text}");
}
