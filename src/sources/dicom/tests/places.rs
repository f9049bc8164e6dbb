use super::*;
use crate::sources::Space;
use glam::DVec3;

/// Frames of 3 x 2 pixels, the first all 0, the second all 1, and so on.
fn frames(count: u16) -> Vec<u16> {
    (0..count).flat_map(|frame| [frame; 6]).collect()
}

fn many(count: u16) -> Dicom {
    let mut dicom = Dicom::empty(EXPLICIT);
    dicom.text(0x0028_0008, b"IS", &count.to_string());
    dicom.image(b"2\\2 ", 16, 16, 0)
}

fn placed(mut dicom: Dicom, z: f64) -> Dicom {
    dicom.text(0x0020_0032, b"DS", &format!("-30\\-25\\{z}"));
    dicom.text(0x0020_0037, b"DS", "1\\0\\0\\0\\1\\0");
    dicom
}

/// The values along z.
fn column(volume: &VolumeData) -> Vec<f32> {
    (0..volume.size[2]).map(|z| volume.sample([0, 0, z]).unwrap()).collect()
}

#[test]
fn frames_of_a_dose_are_where_its_offsets_say() {
    let folder = Folder::new();
    let dose = |first: f64, offsets: &str| {
        let mut dicom = placed(many(3), first);
        dicom.text(0x3004_000c, b"DS", offsets);
        dicom.text(0x3004_000e, b"DS", "0.5");
        folder.read("a.dcm", dicom.pixels(&frames(3)).file())
    };
    let lowest = |volume: &VolumeData| volume.frame.origin.z;
    let up = dose(10.0, "0\\3\\6");
    assert_eq!((up.spacing, column(&up), lowest(&up)), (Vec3::new(2.0, 2.0, 3.0), vec![0.0, 0.5, 1.0], 10.0));
    let down = dose(10.0, "0\\-3\\-6");
    assert_eq!((down.spacing.z, column(&down), lowest(&down)), (3.0, vec![1.0, 0.5, 0.0], 4.0));
    let absolute = dose(100.0, "100\\103\\106");
    assert_eq!((absolute.spacing.z, column(&absolute), lowest(&absolute)), (3.0, vec![0.0, 0.5, 1.0], 100.0));
    let falling = dose(100.0, "100\\97\\94");
    assert_eq!((column(&falling), lowest(&falling)), (vec![1.0, 0.5, 0.0], 94.0));
    let uneven = dose(0.0, "0\\3\\9");
    assert!(uneven.notes.join("\n").contains("3.000 to 6.000 mm apart"), "{:?}", uneven.notes);
    let short = dose(0.0, "0\\3");
    assert!(short.notes.join("\n").contains("has 2 places for 3 frames"), "{:?}", short.notes);
}

#[test]
fn heights_of_a_dose_in_a_patient_who_lies_on_the_face() {
    let folder = Folder::new();
    let mut dicom = many(2);
    dicom.text(0x0020_0032, b"DS", "0\\0\\50");
    // The normal points down; heights in the patient still go up.
    dicom.text(0x0020_0037, b"DS", "1\\0\\0\\0\\-1\\0");
    dicom.text(0x3004_000c, b"DS", "50\\54");
    let volume = folder.read("a.dcm", dicom.pixels(&frames(2)).file());
    assert_eq!((column(&volume), volume.frame.origin.z, volume.spacing.z), (vec![0.0, 1.0], 50.0, 4.0));
}

#[test]
fn frames_of_an_emission_go_the_way_that_their_distance_says() {
    let folder = Folder::new();
    let read = |step: &str, first: f64, in_detector: bool| {
        let mut dicom = if in_detector { many(3) } else { placed(many(3), first) };
        dicom.text(0x0018_0088, b"DS", step);
        if in_detector {
            dicom.sequence(
                0x0054_0022,
                &[
                    &|item: &mut Dicom| {
                        item.text(0x0020_0032, b"DS", &format!("-30\\-25\\{first}"));
                        item.text(0x0020_0037, b"DS", "1\\0\\0\\0\\1\\0");
                    },
                    &|item: &mut Dicom| item.text(0x0020_0032, b"DS", "9\\9\\9"),
                ],
            );
        }
        folder.read("a.dcm", dicom.pixels(&frames(3)).file())
    };
    for in_detector in [false, true] {
        let up = read("4", 0.0, in_detector);
        assert_eq!((column(&up), up.spacing.z), (vec![0.0, 1.0, 2.0], 4.0));
        // The far corner of the first frame, to the right and in front.
        assert_eq!(
            (up.frame.origin, up.frame.space),
            (DVec3::new(30.0 - 4.0, 25.0 - 2.0, 0.0), Space::Patient)
        );
        let down = read("-4", 60.0, in_detector);
        assert_eq!((column(&down), down.frame.origin.z), (vec![2.0, 1.0, 0.0], 52.0));
        assert!(up.notes.join("\n").contains("left, posterior, superior"), "{:?}", up.notes);
    }
    // A heart in two phases of its beat.
    let mut gated = placed(many(4), 0.0);
    gated.text(0x0018_0088, b"DS", "4");
    gated.add(0x0054_0080, b"US", &[1, 0, 2, 0, 1, 0, 2, 0]);
    let path = folder.file("gated.dcm", gated.pixels(&frames(4)).file());
    let phase = |index| read_file(&path, &Selection { index, ..Selection::default() });
    assert_eq!(column(&phase(0).unwrap()), [0.0, 1.0]);
    assert_eq!(column(&phase(1).unwrap()), [2.0, 3.0]);
    assert!(phase(2).unwrap_err().to_string().contains("index: 2 is beyond the last of its 2 volumes"));
}

#[test]
fn slices_without_a_position_are_ordered_by_their_location() {
    let folder = Folder::new();
    for (number, location) in [(1, "6"), (2, "3"), (3, "0")] {
        let mut dicom = Dicom::empty(EXPLICIT);
        dicom.text(0x0020_0013, b"IS", &format!("{number}"));
        dicom.text(0x0020_0037, b"DS", "1\\0\\0\\0\\1\\0");
        dicom.text(0x0020_1041, b"DS", location);
        folder.file(&format!("{number}"), dicom.image(b"1\\1 ", 16, 16, 0).pixels(&[number; 6]).file());
    }
    let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
    assert_eq!((volume.spacing.z, column(&volume)), (3.0, vec![3.0, 2.0, 1.0]));
    assert_eq!(volume.frame.space, Space::Unknown);
    assert!(volume.notes.join("\n").contains("no position in the patient"), "{:?}", volume.notes);
}

/// Every voxel of an oblique series is where its file says, to a thousandth of a millimetre.
#[test]
fn oblique_and_leaning_slices_lie_where_they_say() {
    let folder = Folder::new();
    let (x, y) = (DVec3::new(0.8, 0.48, 0.36), DVec3::new(-0.6, 0.64, 0.48));
    let normal = x.cross(y);
    for leaning in [DVec3::ZERO, y * 0.7] {
        let step = normal * 2.0 + leaning;
        let begin = DVec3::new(12.5, -40.0, 700.0);
        for slice in 0..4_u16 {
            let at = begin + step * f64::from(slice);
            let mut dicom = Dicom::empty(EXPLICIT);
            dicom.text(0x0020_0032, b"DS", &format!("{}\\{}\\{}", at.x, at.y, at.z));
            dicom.text(0x0020_0037, b"DS", &format!("{}\\{}\\{}\\{}\\{}\\{}", x.x, x.y, x.z, y.x, y.y, y.z));
            let pixels: Vec<u16> = (0..6).map(|pixel| 10 * slice + pixel).collect();
            folder.file(&format!("{slice}"), dicom.image(b"0.5\\0.25", 16, 16, 0).pixels(&pixels).file());
        }
        let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
        assert!((volume.spacing.z - 2.0).abs() < 1e-5, "{}", volume.spacing);
        for slice in 0..4_u16 {
            for (column, row) in [(0, 0), (2, 0), (1, 1)] {
                let there = (begin
                    + step * f64::from(slice)
                    + x * 0.25 * f64::from(column)
                    + y * 0.5 * f64::from(row))
                    * DVec3::new(-1.0, -1.0, 1.0);
                let value = f32::from(10 * slice + column + 3 * row);
                let mut found = 0;
                for at in 0..24_u32 {
                    let voxel = [
                        at % volume.size[0],
                        at / volume.size[0] % volume.size[1],
                        at / (volume.size[0] * volume.size[1]),
                    ];
                    if volume.sample(voxel) == Some(value) {
                        found += 1;
                        let [a, b, c] = volume.frame.directions;
                        let spacing = volume.spacing.as_dvec3();
                        let placed = volume.frame.origin
                            + a * spacing.x * f64::from(voxel[0])
                            + b * spacing.y * f64::from(voxel[1])
                            + c * spacing.z * f64::from(voxel[2]);
                        assert!(placed.distance(there) < 1e-3, "{placed} for {there}");
                    }
                }
                assert_eq!(found, 1);
            }
        }
        let tells = volume.notes.join("\n").contains("stacked at 19.3° (a tilted gantry)");
        assert_eq!(tells, leaning != DVec3::ZERO, "{:?}", volume.notes);
    }
}
