#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Cursor;

use ::tiff::encoder::{Compression, TiffEncoder, colortype};
use glam::Vec3;

use super::super::{
    Samples,
    self_describing::tests::{Folder, mutate, values},
};

/// A value of a directory: its type, how many, and their bytes.
type Entry = (u16, u16, u32, Vec<u8>);

/// Pages as they are written byte by byte, in either order: 2 x 3 pixels of `bits` bits, with further entries.
fn tiff(big_endian: bool, bits: u16, pages: &[&[u8]], entries: &[Entry]) -> Vec<u8> {
    let word = |number: u16| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
    let long = |number: u32| if big_endian { number.to_be_bytes() } else { number.to_le_bytes() };
    let mut file = if big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
    file.extend(long(0));
    let mut link = 4;
    for (number, data) in pages.iter().enumerate() {
        let data_at = file.len() as u32;
        file.extend_from_slice(data);
        let mut all: Vec<Entry> = vec![
            (256, 3, 1, word(2).to_vec()),
            (257, 3, 1, word(3).to_vec()),
            (258, 3, 1, word(bits).to_vec()),
            (259, 3, 1, word(1).to_vec()),
            (262, 3, 1, word(1).to_vec()),
            (273, 4, 1, long(data_at).to_vec()),
            (277, 3, 1, word(1).to_vec()),
            (278, 3, 1, word(3).to_vec()),
            (279, 4, 1, long(data.len() as u32).to_vec()),
        ];
        // Descriptions stand on the first page only.
        for entry in entries.iter().filter(|entry| number == 0 || entry.0 != 270) {
            all.retain(|(tag, ..)| *tag != entry.0);
            all.push(entry.clone());
        }
        all.sort();
        for (.., value) in &mut all {
            if value.len() > 4 {
                let at = file.len() as u32;
                file.append(value);
                value.extend(long(at));
            }
            value.resize(4, 0);
        }
        let at = file.len() as u32;
        file[link..link + 4].copy_from_slice(&long(at));
        file.extend(word(all.len() as u16));
        for (tag, kind, count, value) in all {
            file.extend([&word(tag)[..], &word(kind), &long(count), &value].concat());
        }
        link = file.len();
        file.extend(long(0));
    }
    file
}

fn described(text: &str) -> Entry {
    (270, 2, text.len() as u32 + 1, [text.as_bytes(), b"\0"].concat())
}

fn ratio(tag: u16, numerator: u32, denominator: u32) -> Entry {
    (tag, 5, 1, [numerator.to_le_bytes(), denominator.to_le_bytes()].concat())
}

fn word(tag: u16, value: u16) -> Entry {
    (tag, 3, 1, value.to_le_bytes().to_vec())
}

fn ramp(count: u8) -> Vec<u8> {
    (0..count).collect()
}

#[test]
fn pages_are_slices_in_either_byte_order_and_packing() {
    let folder = Folder::new();
    let bytes = ramp(24);
    let pages: Vec<&[u8]> = bytes.chunks(6).collect();
    let volume = folder.read("a.tif", tiff(false, 8, &pages, &[]));
    assert_eq!(
        (volume.size, volume.spacing, &volume.samples),
        ([2, 3, 4], Vec3::ONE, &Samples::U8(ramp(24)))
    );
    assert_eq!(volume.notes, ["it does not say how far apart voxels are; 1 mm is taken"]);
    assert_eq!(folder.read("a.tif", tiff(true, 8, &pages, &[])), volume);
    let packed = |compression: Compression, big: bool| {
        let mut file = Cursor::new(Vec::new());
        macro_rules! write_pages {
            ($encoder:expr) => {{
                let mut encoder = $encoder.unwrap().with_compression(compression);
                for page in &pages {
                    encoder.write_image::<colortype::Gray8>(2, 3, page).unwrap();
                }
            }};
        }
        if big {
            write_pages!(TiffEncoder::new_big(&mut file));
        } else {
            write_pages!(TiffEncoder::new(&mut file));
        }
        file.into_inner()
    };
    for compression in [
        Compression::Uncompressed,
        Compression::Lzw,
        Compression::Deflate(Default::default()),
        Compression::Packbits,
    ] {
        for big in [false, true] {
            assert_eq!(folder.read("a.tif", packed(compression, big)).samples, volume.samples, "{big}");
        }
    }
}

#[test]
fn every_type_of_samples_is_read() {
    let folder = Folder::new();
    let read = |bits: u16, kind: u16, number: &[u8]| {
        let file = tiff(false, bits, &[&number.repeat(6)], &[word(339, kind)]);
        values(&folder.read("a.tif", file))[5]
    };
    assert_eq!(read(8, 2, &[0xff]), -1.0);
    assert_eq!(read(16, 1, &60000_u16.to_le_bytes()), 60000.0);
    assert_eq!(read(16, 2, &(-300_i16).to_le_bytes()), -300.0);
    assert_eq!(read(32, 1, &70000_u32.to_le_bytes()), 70000.0);
    assert_eq!(read(32, 2, &(-70000_i32).to_le_bytes()), -70000.0);
    assert_eq!(read(64, 1, &5_u64.to_le_bytes()), 5.0);
    assert_eq!(read(64, 2, &(-5_i64).to_le_bytes()), -5.0);
    assert_eq!(read(16, 3, &half::f16::from_f32(0.5).to_le_bytes()), 0.5);
    assert_eq!(read(32, 3, &0.25_f32.to_le_bytes()), 0.25);
    assert_eq!(read(64, 3, &0.25_f64.to_le_bytes()), 0.25);
    // Several samples a byte, in rows that begin at a byte.
    let bits = folder.read("a.tif", tiff(true, 1, &[&[0b1000_0000, 0b0100_0000, 0b1100_0000]], &[]));
    assert_eq!(values(&bits), [1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let halves = folder.read("a.tif", tiff(false, 4, &[&[0x12, 0x34, 0xf0]], &[]));
    assert_eq!(values(&halves), [1.0, 2.0, 3.0, 4.0, 15.0, 0.0]);
}

#[test]
fn colours_planes_and_tables_of_colours_are_read() {
    let folder = Folder::new();
    let rgb = [word(262, 2), word(277, 3), (258, 3, 3, [8_u16.to_le_bytes(); 3].concat())];
    let Samples::Rgba8(colours) = folder.read("a.tif", tiff(false, 8, &[&ramp(18)], &rgb)).samples else {
        panic!()
    };
    assert_eq!((colours.len(), colours[1]), (6, [3, 4, 5, 255]));
    let planar = [
        &rgb[..],
        &[
            word(284, 2),
            (273, 4, 3, [8_u32, 14, 20].map(u32::to_le_bytes).concat()),
            (279, 4, 3, [6_u32.to_le_bytes(); 3].concat()),
        ],
    ]
    .concat();
    let file = tiff(false, 8, &[&ramp(18)], &planar);
    let Samples::Rgba8(colours) = folder.read("a.tif", &file).samples else { panic!() };
    assert_eq!(colours[1], [1, 7, 13, 255]);
    assert_eq!(values(&folder.chosen("a.tif", &file, 0, Some(2)).unwrap())[..2], [12.0, 13.0]);
    // A table of colours: the indices are the samples.
    let table = [word(262, 3), (320, 3, 768, vec![7; 1536])];
    let file = tiff(false, 8, &[&ramp(6), &ramp(6)], &table);
    let indices = folder.read("a.tif", file);
    assert_eq!(values(&indices)[..6], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!(indices.notes[0].contains("indices of a table of colours"), "{:?}", indices.notes);
    let inverted = folder.read("a.tif", tiff(false, 8, &[&ramp(6)], &[word(262, 0)]));
    assert_eq!(values(&inverted)[1], 254.0);
    assert!(inverted.notes[0].contains("turned round"), "{:?}", inverted.notes);
}

#[test]
fn distances_are_those_of_the_resolution_of_image_j_or_of_ome() {
    let folder = Folder::new();
    let bytes = ramp(24);
    let pages: Vec<&[u8]> = bytes.chunks(6).collect();
    let read = |entries: &[Entry]| folder.read("a.tif", tiff(false, 8, &pages, entries));
    let dots = read(&[ratio(282, 254, 1), ratio(283, 127, 1), word(296, 2)]);
    assert!(dots.spacing.abs_diff_eq(Vec3::new(0.1, 0.2, 0.1), 1e-6), "{}", dots.spacing);
    assert!(dots.notes[0].contains("how far apart its pages are"), "{:?}", dots.notes);
    assert_eq!(read(&[ratio(282, 20, 1), ratio(283, 20, 1), word(296, 3)]).spacing, Vec3::splat(0.5));
    let image_j =
        "ImageJ=1.53t\nimages=4\nslices=4\nunit=\\u00B5m\nspacing=2.5\nloop=false\nmin=3.0\nmax=17.0\n";
    let scaled = [described(image_j), ratio(282, 2, 1), ratio(283, 2, 1), word(296, 1)];
    let microscope = read(&scaled);
    assert!(
        microscope.spacing.abs_diff_eq(Vec3::new(0.0005, 0.0005, 0.0025), 1e-9),
        "{}",
        microscope.spacing
    );
    assert_eq!((microscope.window, microscope.notes.len()), (Some((3.0, 17.0)), 0));
    let pixels = read(&[described("ImageJ=1.53t\nimages=4\nslices=4\nspacing=3\n"), word(296, 1)]);
    assert_eq!(pixels.spacing, Vec3::new(1.0, 1.0, 3.0));
    let ome = "<?xml version=\"1.0\"?><OME xmlns=\"http://x\"><Image><Pixels DimensionOrder=\"XYCZT\" SizeX=\"2\" SizeY=\"3\" SizeZ=\"2\" SizeC=\"2\" SizeT=\"1\" PhysicalSizeX=\"0.5\" PhysicalSizeY=\"0.5\" PhysicalSizeZ=\"2\" PhysicalSizeZUnit=\"nm\"/></Image></OME>";
    let stack = tiff(false, 8, &pages, &[described(ome)]);
    let second = folder.chosen("a.ome.tif", &stack, 0, Some(1)).unwrap();
    assert!(second.spacing.abs_diff_eq(Vec3::new(5e-4, 5e-4, 2e-6), 1e-9), "{}", second.spacing);
    assert_eq!(
        (second.size, values(&second)[..2].to_vec(), values(&second)[6]),
        ([2, 3, 2], vec![6.0, 7.0], 18.0)
    );
    let other = read(&[described(&ome.replace("SizeZ=\"2\"", "SizeZ=\"7\""))]);
    assert!(other.size[2] == 4 && other.notes[0].contains("counts 7 x 2 x 1 pages"), "{:?}", other.notes);
}

#[test]
fn channels_slices_and_frames_of_image_j_are_told_apart() {
    let folder = Folder::new();
    let bytes = ramp(72);
    let pages: Vec<&[u8]> = bytes.chunks(6).collect();
    let text = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n";
    let stack = tiff(false, 8, &pages, &[described(text)]);
    // Page 1 + 2 * (2 + 3 * 1) is channel 1 of slice 2 of frame 1.
    let chosen = folder.chosen("a.tif", &stack, 1, Some(1)).unwrap();
    assert_eq!((chosen.size, chosen.sample([1, 0, 2])), ([2, 3, 3], Some(67.0)));
    assert!(folder.chosen("a.tif", &stack, 2, None).unwrap_err().ends_with("its 2 volumes are 0 to 1"));
    // Large stacks have a directory for the first page only; the samples of all follow those of the first.
    let large = tiff(
        true,
        16,
        &[&[ramp(72), ramp(72)].concat()],
        &[described(&text.replace("channels=2", "channels=1").replace("images=12", "images=6"))],
    );
    let chosen = folder.chosen("a.tif", &large, 1, None).unwrap();
    assert_eq!(
        (chosen.size, chosen.sample([0, 0, 0])),
        ([2, 3, 3], Some(f32::from(u16::from_be_bytes([36, 37]))))
    );
    let frames = tiff(false, 8, &pages, &[described("ImageJ=1.53t\nimages=12\nframes=12\n")]);
    assert_eq!(folder.read("a.tif", frames).size, [2, 3, 12]);
}

#[test]
fn what_is_wrong_is_told() {
    let folder = Folder::new();
    let of = |bits: u16, entries: &[Entry]| folder.refusal("a.tif", tiff(false, bits, &[&ramp(6)], entries));
    assert!(of(8, &[word(259, 6)]).contains("its page 1 is not read"));
    assert!(of(24, &[]).contains("24 bits"));
    assert!(of(8, &[word(32997, 2)]).contains("page 1 is a volume by itself"));
    assert!(
        of(8, &[word(262, 5), word(277, 4), (258, 3, 4, [8_u16.to_le_bytes(); 4].concat())]).contains("CMYK")
    );
    assert!(
        of(
            8,
            &[
                (256, 4, 1, 60_000_u32.to_le_bytes().to_vec()),
                (257, 4, 1, 60_000_u32.to_le_bytes().to_vec()),
                (278, 4, 1, 60_000_u32.to_le_bytes().to_vec())
            ]
        )
        .contains("beyond the limit")
    );
    assert!(folder.refusal("a.tif", b"II*\0\x08\0\0\0").contains("page 1"));
    // A page of another size among the others.
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    encoder.write_image::<colortype::Gray8>(2, 3, &ramp(6)).unwrap();
    encoder.write_image::<colortype::Gray8>(1, 1, &[1]).unwrap();
    let volume = folder.read("a.tif", file.into_inner());
    assert_eq!(
        (volume.size, &*volume.notes[0]),
        ([2, 3, 1], "1 of its 2 pages are of another size or kind, and left out")
    );
}

#[test]
fn rows_of_packed_tiles_that_come_out_of_the_last_bytes_are_read() {
    let folder = Folder::new();
    // A tile of 16 x 16 sevens, by LZW: its last codes stand for more than a row each.
    let packed = b"\x80\x01\xe0\x50\x38\x24\x16\x0d\x07\x84\x42\x61\x50\xb8\x64\x36\x1d\x0f\x88\x44\x62\x51\x38\xa4\x56\x2d\x03\x80\x80";
    let side = |tag: u16| word(tag, 16);
    let mut entries = vec![side(256), side(257), word(259, 5), side(322), side(323)];
    entries.push((324, 4, 1, 8_u32.to_le_bytes().to_vec()));
    entries.push((325, 4, 1, (packed.len() as u32).to_le_bytes().to_vec()));
    let mut file = tiff(false, 8, &[packed], &entries);
    // Strips and tiles exclude each other.
    for tag in [273_u16, 278, 279] {
        let at = file
            .windows(4)
            .rposition(|bytes| bytes[..2] == tag.to_le_bytes() && matches!(bytes[2], 3 | 4))
            .unwrap();
        file[at..at + 2].copy_from_slice(&60_000_u16.to_le_bytes());
    }
    assert_eq!(folder.read("a.tif", &file).samples, Samples::U8(vec![7; 256]));
}

#[test]
fn dicom_with_the_mark_of_tiff_is_dicom() {
    let mut head = b"II*\0".to_vec();
    head.resize(128, 0);
    assert!(super::is_tiff(&head) && !super::is_tiff(&[&head[..], b"DICM"].concat()));
}

#[test]
fn smaller_versions_and_masks_are_left_out() {
    let folder = Folder::new();
    for kind in [1_u32, 4] {
        let bytes = ramp(24);
        let mut file =
            tiff(false, 8, &[&bytes[..6], &bytes[6..12]], &[(254, 4, 1, 7_u32.to_le_bytes().to_vec())]);
        // The first page is none of them.
        let first = file.windows(12).position(|entry| entry[..8] == [254, 0, 4, 0, 1, 0, 0, 0]).unwrap();
        file[first + 8] = 0;
        let second = first
            + 12
            + file[first + 12..].windows(8).position(|entry| *entry == [254, 0, 4, 0, 1, 0, 0, 0]).unwrap();
        file[second + 8] = kind as u8;
        let volume = folder.read("a.tif", &file);
        assert_eq!((volume.size, values(&volume)[5]), ([2, 3, 1], 5.0));
        assert!(volume.notes[0].starts_with("1 of its 2 pages are of another"), "{:?}", volume.notes);
    }
}

#[test]
fn damaged_files_never_panic() {
    let bytes = ramp(24);
    let pages: Vec<&[u8]> = bytes.chunks(6).collect();
    let file = tiff(false, 8, &pages, &[described("ImageJ=1\nimages=4\nslices=4\nunit=mm\nspacing=2\n")]);
    mutate("a.tif", &file, file.len());
    for compression in [Compression::Lzw, Compression::Deflate(Default::default()), Compression::Packbits] {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).unwrap().with_compression(compression);
        encoder.write_image::<colortype::RGB16>(2, 2, &[7; 12]).unwrap();
        encoder.write_image::<colortype::RGB16>(2, 2, &[9; 12]).unwrap();
        let file = file.into_inner();
        mutate("a.tif", &file, file.len());
    }
    let table = tiff(true, 8, &pages, &[(262, 3, 1, vec![0, 3])]);
    mutate("a.tif", &table, table.len());
}
