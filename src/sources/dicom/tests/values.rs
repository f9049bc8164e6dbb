use super::*;

#[test]
fn decimal_commas_are_points() {
    let folder = Folder::new();
    let mut dicom = Dicom::empty(EXPLICIT);
    dicom.text(0x0018_0050, b"DS", "1,5");
    dicom.text(0x0020_0032, b"DS", "-6,5\\-5\\ 2,25");
    dicom.text(0x0020_0037, b"DS", "1,0\\0\\0\\0\\1\\0,0");
    let mut dicom = dicom.image(b"0,5\\0,25 ", 16, 16, 0);
    dicom.text(0x0028_1052, b"DS", "-100,5");
    dicom.text(0x0028_1053, b"DS", "0,5");
    let volume = folder.read("a.dcm", dicom.pixels(&PIXELS).file());
    assert_eq!(volume.spacing, Vec3::new(0.25, 0.5, 1.5));
    assert_eq!(values(&volume)[..2], [-97.5, -98.0]);
    // The last pixel is the first one here: two columns to the left and one row behind the position.
    assert_eq!(volume.frame.origin, glam::DVec3::new(6.5 - 0.5, 5.0 - 0.5, 2.25));
}

#[test]
fn what_cannot_be_read_and_matters_is_refused_by_name_and_value() {
    let folder = Folder::new();
    for (tag, vr, text, told) in [
        (0x0028_0030, b"DS", "a\\b", "PixelSpacing (0028,0030): `a\\b` is not of decimal numbers"),
        (0x0020_0032, b"DS", "1\\2", "ImagePositionPatient (0020,0032): `1\\2` has 2 numbers, expected 3"),
        (0x0020_0037, b"DS", "1\\0\\0\\0\\x\\0", "ImageOrientationPatient (0020,0037)"),
        (0x0028_1053, b"DS", "1.2.3", "RescaleSlope (0028,1053): `1.2.3`"),
        (0x0028_1052, b"DS", "--5", "RescaleIntercept (0028,1052): `--5`"),
        (0x0028_0008, b"IS", "two", "NumberOfFrames (0028,0008): `two`"),
        (0x3004_000e, b"DS", "1e999", "DoseGridScaling (3004,000e): `1e999`"),
    ] {
        let mut dicom = Dicom::slice(EXPLICIT, 0.0, "1");
        dicom.text(tag, vr, text);
        let refused = folder.refusal("a.dcm", dicom.pixels(&PIXELS).file());
        assert!(refused.contains(told), "{refused}");
        assert!(refused.contains("correct it, as with `dcmodify"), "{refused}");
    }
    // The distance of slices matters where nothing else says it.
    let mut lone = Dicom::empty(EXPLICIT);
    lone.text(0x0018_0088, b"DS", "near");
    let refused = folder.refusal("a.dcm", lone.image(b"1\\1 ", 16, 16, 0).pixels(&PIXELS).file());
    assert!(refused.contains("SpacingBetweenSlices (0018,0088): `near`"), "{refused}");
}

#[test]
fn what_cannot_be_read_and_does_not_matter_is_told() {
    let folder = Folder::new();
    for z in 0..3 {
        let mut dicom = Dicom::slice(EXPLICIT, f64::from(z), "1");
        dicom.text(0x0020_0013, b"IS", "third");
        dicom.text(0x0028_1050, b"DS", "middle");
        dicom.text(0x0018_0088, b"DS", "1.x");
        folder.file(&format!("{z}"), dicom.pixels(&[z; 6]).file());
    }
    let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
    let notes = volume.notes.join("\n");
    assert_eq!((volume.spacing.z, volume.window), (1.0, None));
    for told in [
        "InstanceNumber (0020,0013) is left out: `third`",
        "in 0, and 2 more like it",
        "WindowCenter (0028,1050) is left out: `middle`",
        "SpacingBetweenSlices (0018,0088) is left out: `1.x`",
    ] {
        assert!(notes.contains(told), "{told}: {notes}");
    }
}

#[test]
fn the_distance_of_pixels_comes_from_the_best_that_is_said() {
    let folder = Folder::new();
    let read = |elements: &[(u32, &str)]| {
        let mut dicom = Dicom::empty(EXPLICIT).image(elements[0].1.as_bytes(), 16, 16, 0);
        for (tag, text) in &elements[1..] {
            dicom.text(*tag, b"DS", text);
        }
        folder.read("a.dcm", dicom.pixels(&PIXELS).file())
    };
    let spacing = |volume: &VolumeData| [volume.spacing.x, volume.spacing.y];
    assert_eq!(spacing(&read(&[(0, "0.5 ")])), [0.5, 0.5]);
    let detector = read(&[(0, "\\ "), (0x0018_1164, "0.2\\0.1")]);
    assert_eq!(spacing(&detector), [0.1, 0.2]);
    assert!(detector.notes[0].contains("ImagerPixelSpacing (0018,1164) is taken"), "{:?}", detector.notes);
    let film = read(&[(0, ""), (0x0018_2010, "0.4"), (0x0028_0034, "2\\1")]);
    assert_eq!(spacing(&film), [0.4, 0.4]);
    let aspect = read(&[(0, ""), (0x0028_0034, "2\\1")]);
    assert_eq!(spacing(&aspect), [1.0, 2.0]);
    let none = read(&[(0, "")]);
    assert_eq!(spacing(&none), [1.0, 1.0]);
    assert!(none.notes[0].contains("does not say how far apart pixels are"), "{:?}", none.notes);
}

#[test]
fn what_the_file_recommends_to_look_at_is_after_scaling() {
    let folder = Folder::new();
    let mut dicom = Dicom::slice(EXPLICIT, 0.0, "1");
    dicom.text(0x0028_1050, b"DS", "40\\300");
    dicom.text(0x0028_1051, b"DS", "400\\1500");
    dicom.text(0x0028_1052, b"DS", "-1024");
    dicom.text(0x0028_0004, b"CS", "MONOCHROME1");
    let volume = folder.read("a.dcm", dicom.pixels(&PIXELS).file());
    assert_eq!(volume.window, Some((-160.0, 240.0)));
    assert_eq!(volume.range, (-1023.0, -1018.0));
    assert!(volume.notes.join("\n").contains("MONOCHROME1"), "{:?}", volume.notes);
}
