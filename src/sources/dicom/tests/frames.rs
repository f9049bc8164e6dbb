use super::*;

/// One file of frames that say for themselves where they are: place, time, stack, slope.
fn enhanced(frames: &[(f64, i32, &str, f64)]) -> Dicom {
    let mut dicom = Dicom::empty(EXPLICIT);
    dicom.text(0x0028_0008, b"IS", &frames.len().to_string());
    dicom.short(0x0028_0002, 1);
    dicom.short(0x0028_0010, 2);
    dicom.short(0x0028_0011, 3);
    for (tag, value) in [(0x0028_0100, 16), (0x0028_0101, 16), (0x0028_0102, 15), (0x0028_0103, 0)] {
        dicom.short(tag, value);
    }
    dicom.sequence(
        0x5200_9229,
        &[&|item: &mut Dicom| {
            item.sequence(
                0x0020_9116,
                &[&|item: &mut Dicom| item.text(0x0020_0037, b"DS", "1\\0\\0\\0\\1\\0")],
            );
            item.sequence(0x0028_9110, &[&|item: &mut Dicom| item.text(0x0028_0030, b"DS", "0.5\\0.5")]);
            item.sequence(
                0x0028_9132,
                &[&|item: &mut Dicom| {
                    item.text(0x0028_1050, b"DS", "50");
                    item.text(0x0028_1051, b"DS", "20");
                }],
            );
            // Of another image: its place is not ours.
            item.sequence(0x0008_1140, &[&|item: &mut Dicom| item.text(0x0020_0032, b"DS", "7\\7\\7")]);
        }],
    );
    let items: Vec<Box<dyn Fn(&mut Dicom)>> = frames
        .iter()
        .map(|&(z, time, stack, slope)| {
            let stack = stack.to_owned();
            Box::new(move |item: &mut Dicom| {
                item.sequence(
                    0x0020_9113,
                    &[&|item: &mut Dicom| item.text(0x0020_0032, b"DS", &format!("0\\0\\{z}"))],
                );
                item.sequence(
                    0x0020_9111,
                    &[&|item: &mut Dicom| {
                        item.text(0x0020_9056, b"SH", &stack);
                        item.add(0x0020_9128, b"UL", &time.to_le_bytes());
                    }],
                );
                item.sequence(
                    0x0028_9145,
                    &[&|item: &mut Dicom| item.text(0x0028_1053, b"DS", &slope.to_string())],
                );
            }) as Box<dyn Fn(&mut Dicom)>
        })
        .collect();
    let items: Vec<&dyn Fn(&mut Dicom)> = items.iter().map(|item| &**item).collect();
    dicom.sequence(0x5200_9230, &items);
    let pixels: Vec<u16> = (0..frames.len() as u16).flat_map(|frame| [frame + 1; 6]).collect();
    dicom.pixels(&pixels)
}

fn column(volume: &VolumeData) -> Vec<f32> {
    (0..volume.size[2]).map(|z| volume.sample([0, 0, z]).unwrap()).collect()
}

#[test]
fn frames_in_any_order_come_apart_by_time_and_stack() {
    let folder = Folder::new();
    // Two times in odd order, the second scaled, and one frame of another stack.
    let frames = [
        (4.0, 1, "a", 1.0),
        (0.0, 1, "a", 1.0),
        (2.0, 2, "a", 10.0),
        (2.0, 1, "a", 1.0),
        (0.0, 2, "a", 10.0),
        (4.0, 2, "a", 10.0),
        (1.0, 1, "b", 100.0),
    ];
    let path = folder.file("a", enhanced(&frames).file());
    let read = |index| read_file(&path, &Selection { index, ..Selection::default() });
    let first = read(0).unwrap();
    assert_eq!((first.size, first.spacing), ([3, 2, 3], Vec3::new(0.5, 0.5, 2.0)));
    assert_eq!((column(&first), first.window), (vec![2.0, 4.0, 1.0], Some((40.0, 60.0))));
    assert_eq!(column(&read(1).unwrap()), [50.0, 30.0, 60.0]);
    assert_eq!(column(&read(2).unwrap()), [700.0]);
    let notes = first.notes.join("\n");
    assert!(notes.contains("4 slices of other directions or stacks"), "{notes}");
    assert!(notes.contains("`index` chooses one of 3 volumes, this is 0"), "{notes}");
    let beyond = read(3).unwrap_err().to_string();
    assert!(
        beyond.contains("index: 3 is beyond the last of its 3 volumes; they count from 0 to 2"),
        "{beyond}"
    );
}

#[test]
fn a_time_that_is_missing_at_a_place_does_not_shift_the_others() {
    let folder = Folder::new();
    // Place 2 has no first time.
    let frames =
        [(0.0, 1, "a", 1.0), (2.0, 2, "a", 1.0), (4.0, 1, "a", 1.0), (0.0, 2, "a", 1.0), (4.0, 2, "a", 1.0)];
    let path = folder.file("a", enhanced(&frames).file());
    let read = |index| column(&read_file(&path, &Selection { index, ..Selection::default() }).unwrap());
    assert_eq!((read(0), read(1)), (vec![1.0, 3.0], vec![4.0, 2.0, 5.0]));
}

#[test]
fn damaged_groups_of_frames_never_panic() {
    let file = enhanced(&[(0.0, 1, "a", 1.0), (2.0, 1, "a", 2.0), (0.0, 2, "b", 1.0)]).file();
    mutate("a.dcm", &file, file.len());
}
