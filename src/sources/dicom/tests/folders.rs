use super::*;
use std::fs;

/// A slice in a folder within another.
fn put(folder: &Folder, path: &str, dicom: &Dicom) {
    let path = folder.path(path);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, dicom.file()).unwrap();
}

fn named(z: f64, series: &str, number: &str, description: &str, value: u16) -> Dicom {
    let mut dicom = Dicom::slice(EXPLICIT, z, series);
    dicom.text(0x0008_103e, b"LO", description);
    dicom.text(0x0020_0011, b"IS", number);
    dicom.pixels(&[value; 6])
}

fn choice(series: &str) -> Selection {
    Selection { series: Some(series.to_owned()), ..Selection::default() }
}

#[test]
fn nested_folders_are_looked_through_and_a_series_can_be_chosen() {
    let folder = Folder::new();
    for z in 0..4 {
        put(&folder, &format!("DICOM/PAT0/STU0/SER0/I{z}"), &named(f64::from(z), "1.2.3", "4", "T1 AX", 40));
    }
    for z in 0..3 {
        put(&folder, &format!("DICOM/PAT0/STU0/SER1/I{z}"), &named(f64::from(z), "1.2.4", "5", "T2 sag", 50));
    }
    put(&folder, "DICOM/PAT0/STU1/SER0/I0", &named(0.0, "1.2.5", "5", "same number", 60));
    folder.file("README.TXT", "viewer");
    let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
    assert_eq!((volume.size, volume.range), ([3, 2, 4], (40.0, 40.0)));
    let notes = volume.notes.join("\n");
    assert!(notes.contains("1 file that is no DICOM is left out, as README.TXT"), "{notes}");
    assert!(
        notes.contains("of 3 series only the largest is read, `T1 AX` of 4 (`series: \"4\"`)"),
        "{notes}"
    );
    // A number that two have chooses neither.
    assert!(
        notes.contains("`T2 sag` of 3 (`series: \"1.2.4\"`), `same number` of 1 (`series: \"1.2.5\"`)"),
        "{notes}"
    );
    for series in ["1.2.4", "t2 SAG", " 1.2.4 "] {
        let chosen = read_folder(&folder.path(""), &choice(series)).unwrap();
        assert_eq!((chosen.size[2], chosen.range.0), (3, 50.0), "{series}");
    }
    let none = read_folder(&folder.path(""), &choice("9")).unwrap_err().to_string();
    assert!(none.contains("no series `9`; there are `T1 AX` of 4"), "{none}");
    assert!(read_file(&folder.path("DICOM/PAT0/STU1/SER0/I0"), &choice("9")).is_err());
    // Damaged ones are not repeated at length.
    put(&folder, "long/I0", &named(0.0, &"1".repeat(4000), "", &"d".repeat(4000), 60));
    let none = read_folder(&folder.path("long"), &choice("9")).unwrap_err().to_string();
    assert!(none.len() < 500, "{none}");
}

#[cfg(unix)]
#[test]
fn links_that_lead_back_end() {
    let folder = Folder::new();
    put(&folder, "a/b/I0", &named(0.0, "1", "1", "x", 1));
    std::os::unix::fs::symlink(folder.path("a"), folder.path("a/b/back")).unwrap();
    std::os::unix::fs::symlink(folder.path("nowhere"), folder.path("a/dangling")).unwrap();
    let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
    assert_eq!(volume.size, [3, 2, 1], "{:?}", volume.notes);
    let mut deep = String::new();
    for _ in 0..40 {
        deep.push_str("d/");
    }
    put(&folder, &format!("{deep}I9"), &named(9.0, "1", "1", "x", 1));
    let notes = read_folder(&folder.path(""), &Selection::default()).unwrap().notes.join("\n");
    assert!(notes.contains("the folder has more files, or deeper ones"), "{notes}");
}

#[test]
fn an_index_is_followed_whatever_the_case_of_names() {
    let folder = Folder::new();
    for z in 0..2 {
        put(&folder, &format!("dicom/i{z}"), &named(f64::from(z), "1", "1", "listed", 1));
    }
    for z in 0..5 {
        put(&folder, &format!("dicom/other{z}"), &named(f64::from(z), "2", "2", "unlisted", 2));
    }
    let index = |files: &[&str]| {
        let mut dicom = Dicom::empty(EXPLICIT);
        dicom.text(0x0004_1130, b"CS", "DISK");
        let items: Vec<Box<dyn Fn(&mut Dicom)>> = files
            .iter()
            .map(|file| {
                let file = (*file).to_owned();
                Box::new(move |item: &mut Dicom| {
                    item.text(0x0004_1430, b"CS", "IMAGE");
                    item.text(0x0004_1500, b"CS", &file);
                }) as Box<dyn Fn(&mut Dicom)>
            })
            .collect();
        let items: Vec<&dyn Fn(&mut Dicom)> = items.iter().map(|item| &**item).collect();
        dicom.sequence(0x0004_1220, &items);
        dicom.file()
    };
    let read =
        |files: &[&str]| read_file(&folder.file("DICOMDIR", index(files)), &Selection::default()).unwrap();
    let listed = read(&["DICOM\\I0", "DICOM\\I1", "DICOM\\GONE", "..\\..\\etc\\passwd"]);
    assert_eq!((listed.size[2], listed.range.0), (2, 1.0));
    let empty = read(&[]);
    assert_eq!((empty.size[2], empty.range.0), (5, 2.0));
    assert!(empty.notes[0].contains("names no file that is there"), "{:?}", empty.notes);
    // A file named .dcm without pixels that is no index either.
    let report = Dicom::slice(EXPLICIT, 0.0, "1");
    assert!(folder.refusal("report.dcm", report.file()).contains("without pixels"));
    mutate("DICOMDIR", &index(&["DICOM\\I0"]), 1000);
}

#[test]
fn slices_of_other_sizes_are_left_out_and_told() {
    let folder = Folder::new();
    for z in 0..3 {
        put(&folder, &format!("{z}"), &named(f64::from(z), "1", "1", "x", 1));
    }
    let mut scout = Dicom::empty(EXPLICIT);
    scout.text(0x0020_000e, b"UI", "1");
    scout.short(0x0028_0010, 1);
    scout.short(0x0028_0011, 6);
    for (tag, value) in [(0x0028_0100, 16), (0x0028_0101, 16), (0x0028_0102, 15)] {
        scout.short(tag, value);
    }
    put(&folder, "scout", &scout.pixels(&PIXELS));
    let volume = read_folder(&folder.path(""), &Selection::default()).unwrap();
    assert_eq!(volume.size, [3, 2, 3]);
    let notes = volume.notes.join("\n");
    assert!(notes.contains("only what is alike is read, 3 of 3 x 2 pixels"), "{notes}");
    assert!(notes.contains("1 of 6 x 1 pixels (scout)"), "{notes}");
}

#[test]
fn files_without_their_mark_are_read_under_any_name() {
    let folder = Folder::new();
    for syntax in [EXPLICIT, IMPLICIT, BIG] {
        let inner = Folder::new();
        for z in 0..2 {
            let mut dicom = Dicom::empty(syntax);
            dicom.text(0x0008_0008, b"CS", "ORIGINAL\\PRIMARY");
            dicom.text(0x0008_0016, b"UI", "1.2.840.10008.5.1.4.1.1.2");
            dicom.text(0x0008_0060, b"CS", "CT");
            dicom.text(0x0020_0032, b"DS", &format!("0\\0\\{z}"));
            let bare = dicom.image(b"1\\1 ", 16, 16, 0).pixels(&PIXELS).bytes;
            inner.file(&format!("IM_{z}.IMA"), &bare);
            assert_eq!(folder.read("one.IMA", &bare).size, [3, 2, 1], "{syntax}");
            assert_eq!(folder.read("one", &bare).size, [3, 2, 1], "{syntax}");
        }
        assert_eq!(read_folder(&inner.path(""), &Selection::default()).unwrap().size, [3, 2, 2], "{syntax}");
    }
    // The first group, but neither preamble nor mark.
    let whole = Dicom::slice(IMPLICIT, 0.0, "1").pixels(&PIXELS).file();
    let mut meta = Dicom::empty(EXPLICIT);
    meta.add(0x0002_0000, b"UL", &[26, 0, 0, 0]);
    meta.add(0x0002_0001, b"OB", &[0, 1]);
    assert_eq!(folder.read("meta", [meta.bytes, whole[132..].to_vec()].concat()).size, [3, 2, 1]);
}
