use super::*;

/// Masks of 4 x 2 pixels: place, segment and bits, the first pixel lowest.
fn masks(form: &str, frames: &[(f64, u16, u8)]) -> Dicom {
    let mut dicom = Dicom::empty(EXPLICIT);
    dicom.text(0x0008_0060, b"CS", "SEG");
    let bits = if form == "BINARY" { 1 } else { 8 };
    for (tag, value) in [
        (0x0028_0002, 1),
        (0x0028_0010, 2),
        (0x0028_0011, 4),
        (0x0028_0100, bits),
        (0x0028_0101, bits),
        (0x0028_0102, bits - 1),
        (0x0028_0103, 0),
    ] {
        dicom.short(tag, value);
    }
    dicom.text(0x0028_0008, b"IS", &frames.len().to_string());
    dicom.text(0x0062_0001, b"CS", form);
    dicom.short(0x0062_000e, 200);
    dicom.sequence(
        0x0062_0002,
        &[
            &|item: &mut Dicom| {
                item.short(0x0062_0004, 1);
                item.text(0x0062_0005, b"LO", "liver");
                item.add(0x0062_000d, b"US", &[0xff, 0xff, 0x80, 0x80, 0x80, 0x80]);
            },
            &|item: &mut Dicom| {
                item.short(0x0062_0004, 3);
                item.text(0x0062_0005, b"LO", "tumour");
            },
        ],
    );
    let items: Vec<Box<dyn Fn(&mut Dicom)>> = frames
        .iter()
        .map(|&(z, segment, _)| {
            Box::new(move |item: &mut Dicom| {
                item.sequence(
                    0x0020_9113,
                    &[&|item: &mut Dicom| item.text(0x0020_0032, b"DS", &format!("0\\0\\{z}"))],
                );
                item.sequence(0x0062_000a, &[&|item: &mut Dicom| item.short(0x0062_000b, segment)]);
            }) as Box<dyn Fn(&mut Dicom)>
        })
        .collect();
    let items: Vec<&dyn Fn(&mut Dicom)> = items.iter().map(|item| &**item).collect();
    dicom.sequence(0x5200_9230, &items);
    let bytes: Vec<u8> = if bits == 1 {
        frames.iter().map(|(.., mask)| *mask).collect()
    } else {
        // Half of a pixel for a bit, and a little more in the third segment.
        frames
            .iter()
            .flat_map(|&(_, segment, mask)| (0..8).map(move |at| (mask >> at & 1) * (100 + segment as u8)))
            .collect()
    };
    let bytes = if bytes.len().is_multiple_of(2) { bytes } else { [bytes, vec![0]].concat() };
    dicom.add(0x7fe0_0010, b"OB", &bytes);
    dicom
}

#[test]
fn masks_become_labels_in_their_planes() {
    let folder = Folder::new();
    // Nothing lies at 4 mm: its masks are left out of the file.
    let frames = [(0.0, 1, 0b0000_0111), (6.0, 1, 0b1000_0000), (0.0, 3, 0b0000_1100), (2.0, 3, 0b0001_0000)];
    let volume = folder.read("a.dcm", masks("BINARY", &frames).file());
    assert_eq!((volume.size, volume.spacing.z), ([4, 2, 4], 2.0));
    let plane = |z: u32| [0, 1].map(|y| [0, 1, 2, 3].map(|x| volume.sample([x, y, z]).unwrap()));
    // The third pixel is of both.
    assert_eq!(plane(0), [[1.0, 1.0, 3.0, 3.0], [0.0; 4]]);
    assert_eq!(plane(1), [[0.0; 4], [3.0, 0.0, 0.0, 0.0]]);
    assert_eq!(plane(2), [[0.0; 4]; 2]);
    assert_eq!(plane(3), [[0.0; 4], [0.0, 0.0, 0.0, 1.0]]);
    let labels = volume.labels.unwrap().entries;
    assert_eq!((labels[0].value, labels[0].name.as_str()), (1.0, "liver"));
    assert!(labels[0].colour.unwrap().iter().all(|channel| *channel > 0.99), "{labels:?}");
    assert_eq!((labels[1].value, labels[1].name.as_str(), labels[1].colour), (3.0, "tumour", None));
    assert!(volume.notes.join("\n").contains("1 voxels belong to several segments"), "{:?}", volume.notes);
}

#[test]
fn fractions_of_one_segment_stay_and_of_several_become_labels() {
    let folder = Folder::new();
    let one = folder.read("a.dcm", masks("FRACTIONAL", &[(0.0, 1, 0b11), (1.0, 1, 0b100)]).file());
    assert_eq!((one.range, one.window, one.labels.is_none()), ((0.0, 101.0), Some((0.0, 200.0)), true));
    assert_eq!(one.sample([2, 0, 1]), Some(101.0));
    let two = folder.read("a.dcm", masks("FRACTIONAL", &[(0.0, 3, 0b11), (0.0, 1, 0b110)]).file());
    // The greater fraction counts.
    assert_eq!([0, 1, 2].map(|x| two.sample([x, 0, 0]).unwrap()), [3.0, 3.0, 1.0]);
    assert!(two.labels.is_some());
}

#[test]
fn masks_that_lie_far_apart_take_no_memory_and_damaged_ones_do_not_panic() {
    let folder = Folder::new();
    let far = [(0.0, 1, 1), (0.5, 1, 1), (1e6, 1, 1)];
    let refused = folder.refusal("a.dcm", masks("BINARY", &far).file());
    assert!(refused.contains("at most 1024 are read"), "{refused}");
    for form in ["BINARY", "FRACTIONAL"] {
        let file = masks(form, &[(0.0, 1, 7), (1.0, 3, 9)]).file();
        mutate("a.dcm", &file, file.len());
    }
}

#[test]
fn pixels_of_one_bit_run_on_across_frames() {
    let folder = Folder::new();
    let mut dicom = Dicom::empty(EXPLICIT);
    dicom.text(0x0028_0008, b"IS", "2");
    let mut dicom = dicom.image(b"1\\1 ", 1, 1, 0);
    // Six pixels a frame: 1, 0, 1, 1, 0, 0, then 0, 1, 1, 1, 1, 1.
    dicom.add(0x7fe0_0010, b"OB", &[0b1000_1101, 0b1111]);
    let volume = folder.read("a.dcm", dicom.file());
    assert_eq!(values(&volume), [1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
}

fn coloured(syntax: &'static str, photometric: &str, planar: u16, bytes: &[u8]) -> Dicom {
    let mut dicom = Dicom::empty(syntax);
    dicom.text(0x0028_0004, b"CS", photometric);
    dicom.short(0x0028_0006, planar);
    for (tag, value) in
        [(0x0028_0010, 1), (0x0028_0011, 2), (0x0028_0100, 8), (0x0028_0101, 8), (0x0028_0102, 7)]
    {
        dicom.short(tag, value);
    }
    dicom.short(0x0028_0002, if photometric == "PALETTE COLOR" { 1 } else { 3 });
    if !bytes.is_empty() {
        dicom.add(0x7fe0_0010, b"OB", bytes);
    }
    dicom
}

fn colours(volume: &VolumeData) -> Vec<[u8; 4]> {
    let Samples::Rgba8(colours) = &volume.samples else { panic!("{:?}", volume.samples) };
    colours.clone()
}

#[test]
fn colours_are_read_in_every_arrangement() {
    let folder = Folder::new();
    let expected = [[255, 0, 0, 255], [10, 20, 30, 255]];
    let read = |dicom: &Dicom| colours(&folder.read("a.dcm", dicom.file()));
    assert_eq!(read(&coloured(EXPLICIT, "RGB", 0, &[255, 0, 0, 10, 20, 30])), expected);
    assert_eq!(read(&coloured(EXPLICIT, "RGB", 1, &[255, 10, 0, 20, 0, 30])), expected);
    // Grey and white, and the same pair with one difference of colour for both.
    assert_eq!(
        read(&coloured(EXPLICIT, "YBR_FULL", 0, &[128, 128, 128, 255, 128, 128])),
        [[128, 128, 128, 255], [255; 4]]
    );
    assert_eq!(
        read(&coloured(EXPLICIT, "YBR_FULL_422", 0, &[128, 255, 128, 128])),
        [[128, 128, 128, 255], [255; 4]]
    );
    let runs = coloured("1.2.840.10008.1.2.5", "RGB", 1, &[]);
    let mut frame = [3_u32, 64, 68, 72].map(u32::to_le_bytes).concat();
    frame.resize(64, 0);
    frame.extend([1, 255, 10, 0, 1, 0, 20, 0, 1, 0, 30, 0]);
    assert_eq!(read(&runs.items(&[], &[&frame])), expected);
}

#[test]
fn colours_of_a_table_are_looked_up() {
    let folder = Folder::new();
    let mut dicom = coloured(EXPLICIT, "PALETTE COLOR", 0, &[]);
    // Three entries from value 4 on, in 16 bits.
    for (channel, entries) in
        [[0_u16, 0xffff, 0x1200], [0, 0x8000, 0x3400], [0, 0, 0x5600]].into_iter().enumerate()
    {
        let channel = channel as u32;
        dicom.add(0x0028_1101 + channel, b"US", &[3, 0, 4, 0, 16, 0]);
        dicom.add(
            0x0028_1201 + channel,
            b"OW",
            &entries.iter().flat_map(|entry| entry.to_le_bytes()).collect::<Vec<u8>>(),
        );
    }
    dicom.add(0x7fe0_0010, b"OB", &[5, 99]);
    let volume = folder.read("a.dcm", dicom.file());
    assert_eq!(colours(&volume), [[255, 128, 0, 255], [0x12, 0x34, 0x56, 255]]);
    assert_eq!(volume.window, None);
    let without = coloured(EXPLICIT, "PALETTE COLOR", 0, &[5, 99]);
    assert!(
        folder.refusal("a.dcm", without.file()).contains("a table of colours that it does not have whole")
    );
    let file = dicom.file();
    mutate("a.dcm", &file, file.len());
}
