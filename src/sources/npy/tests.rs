#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::super::{
    Samples,
    self_describing::tests::{Folder, mutate, values},
};

fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut text = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': ({shape}), }}");
    text.push_str(&" ".repeat(63 - (10 + text.len()) % 64));
    text.push('\n');
    [b"\x93NUMPY\x01\x00".as_slice(), &(text.len() as u16).to_le_bytes(), text.as_bytes(), data].concat()
}

fn ramp() -> Vec<u8> {
    (0..24).collect()
}

#[test]
fn the_last_three_axes_are_z_y_and_x_in_either_order() {
    let folder = Folder::new();
    let volume = folder.read("a.npy", npy("'|u1'", false, "4, 3, 2", &ramp()));
    assert_eq!((volume.size, &volume.samples), ([2, 3, 4], &Samples::U8(ramp())));
    assert_eq!(volume.notes, ["it does not say how far apart voxels are; 1 mm is taken"]);
    // The same array, the first axis fastest: element (z, y, x) stands at z + 4 y + 12 x.
    let mut fortran = vec![0; 24];
    for (index, value) in ramp().into_iter().enumerate() {
        fortran[index / 6 + index / 2 % 3 * 4 + index % 2 * 12] = value;
    }
    let turned = folder.read("a.npy", npy("'|u1'", true, "4, 3, 2", &fortran));
    assert_eq!((turned.size, &turned.samples), ([2, 3, 4], &volume.samples));
    assert_eq!(folder.read("a.npy", npy("'|u1'", false, "24,", &ramp())).size, [24, 1, 1]);
    assert_eq!(folder.read("a.npy", npy("'|u1'", false, "8, 3", &ramp())).size, [3, 8, 1]);
    // Another version, and what Python 2 wrote.
    let text = b"{\"shape\": (4L, 3L, 2L), \"fortran_order\": False, \"descr\": \"|u1\"}\n";
    let second =
        [b"\x93NUMPY\x02\x00".as_slice(), &(text.len() as u32).to_le_bytes(), text, &ramp()].concat();
    assert_eq!(folder.read("a.npy", second).samples, volume.samples);
}

#[test]
fn every_type_of_real_numbers_is_read() {
    let folder = Folder::new();
    let read =
        |descr: &str, bytes: &[u8]| values(&folder.read("a.npy", npy(descr, false, "1, 1, 1", bytes)))[0];
    assert_eq!(read("'|b1'", &[1]), 1.0);
    assert_eq!(read("'|i1'", &[0xff]), -1.0);
    assert_eq!(read("'<u2'", &513_u16.to_le_bytes()), 513.0);
    assert_eq!(read("'>i2'", &(-300_i16).to_be_bytes()), -300.0);
    assert_eq!(read("'<u4'", &70000_u32.to_le_bytes()), 70000.0);
    assert_eq!(read("'>i4'", &(-70000_i32).to_be_bytes()), -70000.0);
    assert_eq!(read("'<u8'", &5_u64.to_le_bytes()), 5.0);
    assert_eq!(read("'>i8'", &(-5_i64).to_be_bytes()), -5.0);
    assert_eq!(read("'<f2'", &half::f16::from_f32(0.5).to_le_bytes()), 0.5);
    assert_eq!(read("'>f2'", &half::f16::from_f32(-2.0).to_be_bytes()), -2.0);
    assert_eq!(read("'<f4'", &0.25_f32.to_le_bytes()), 0.25);
    assert_eq!(read("'>f8'", &0.25_f64.to_be_bytes()), 0.25);
}

#[test]
fn further_axes_are_volumes_and_numbers_of_a_voxel() {
    let folder = Folder::new();
    let times = npy("'|u1'", false, "2, 2, 3, 2", &ramp());
    let second = folder.chosen("a.npy", npy("'|u1'", false, "2, 2, 1, 6", &ramp()), 1, None).unwrap();
    assert_eq!((second.size, second.sample([0; 3])), ([6, 1, 2], Some(12.0)));
    // Two numbers behind three axes are those of a voxel.
    let pairs = folder.chosen("a.npy", &times, 0, Some(1)).unwrap();
    assert_eq!((pairs.size, values(&pairs)[..3].to_vec()), ([3, 2, 2], vec![1.0, 3.0, 5.0]));
    let Samples::Rgba8(colours) = folder.read("a.npy", npy("'|u1'", false, "2, 2, 2, 3", &ramp())).samples
    else {
        panic!()
    };
    assert_eq!(colours[1], [3, 4, 5, 255]);
    let picture = folder.read("a.npy", npy("'|u1'", false, "2, 4, 3", &ramp()));
    assert_eq!((picture.size, picture.samples.len()), ([4, 2, 1], 8));
    assert!(picture.notes[0].contains("3 long, is taken for the channels"), "{:?}", picture.notes);
}

#[test]
fn what_is_wrong_is_told() {
    let folder = Folder::new();
    let refused = |descr: &str, shape: &str| folder.refusal("a.npy", npy(descr, false, shape, &ramp()));
    assert!(
        refused("'|u1'", "4, 3, 5").contains("24 bytes after its header; 5 x 3 x 4 voxels of 1 byte need 60")
    );
    assert!(
        refused("'<c8'", "3,").contains("its elements are of type '<c8', no real numbers; save an array")
    );
    assert!(refused("[('a', '<f4'), ('b', '<i2')]", "4,").contains("no real numbers"));
    assert!(refused("'|u1'", "4, -3").contains("shape: expected sizes such as (4, 3, 2)"));
    assert!(refused("'|u1'", "0, 3").contains("every side"));
    assert!(refused("'<f8'", "99999999999, 99999999999").contains("limit"));
    assert!(
        folder
            .refusal("a.npy", b"\x93NUMPY\x01\x00\x10\x00{'shape': (1,)}  ")
            .contains("descr: it is missing")
    );
    assert!(folder.refusal("a.npy", b"\x93NUMPY\x07\x00").contains("expected 1, 2 or 3, found 7"));
    assert!(folder.refusal("a.npy", b"\x93NUMPY\x01\x00\xff\xff{").contains("cut off"));
}

#[test]
fn damaged_headers_never_panic() {
    let file = npy("'<f4'", false, "1, 3, 2", &ramp());
    mutate("a.npy", &file, file.len());
    let file = npy("'|u1'", true, "2, 2, 2, 3", &ramp());
    mutate("a.npy", &file, file.len());
}
