//! Frames that are packed. The pictures are of 16 x 8 pixels, made with IJG's JPEG, CharLS, OpenJPEG and OpenJPH.

use super::*;

/// `8 x + 5 y`, with the least loss there is.
const JPEG: &str = "ffd8ffe000104a46494600010100000100010000ffdb004300010101010101010101010101010101010101010101010101010101010101\
    01010101010101010101010101010101010101010101010101010101010101010101ffc0000b080008001001011100ffc4001f00000105\
    01010101010100000000000000000102030405060708090a0bffc400b5100002010303020403050504040000017d010203000411051221\
    31410613516107227114328191a1082342b1c11552d1f02433627282090a161718191a25262728292a3435363738393a43444546474849\
    4a535455565758595a636465666768696a737475767778797a838485868788898a92939495969798999aa2a3a4a5a6a7a8a9aab2b3b4b5\
    b6b7b8b9bac2c3c4c5c6c7c8c9cad2d3d4d5d6d7d8d9dae1e2e3e4e5e6e7e8e9eaf1f2f3f4f5f6f7f8f9faffda0008010100003f00fe5a\
    ff0066df849ff1e1fe8bff003cbf83e9ed5fd007ecdbf093fe3c3fd17fe797f07d3dabffd9";
/// Red `15 x`, green `30 y`, blue `255 - 15 x`, with the least loss there is.
const JPEG_COLOUR: &str = "ffd8ffe000104a46494600010100000100010000ffdb004300010101010101010101010101010101010101010101010101010101010101\
    01010101010101010101010101010101010101010101010101010101010101010101ffdb00430101010101010101010101010101010101\
    010101010101010101010101010101010101010101010101010101010101010101010101010101010101010101010101ffc00011080008\
    001003011100021101031101ffc4001f0000010501010101010100000000000000000102030405060708090a0bffc400b5100002010303\
    020403050504040000017d01020300041105122131410613516107227114328191a1082342b1c11552d1f02433627282090a161718191a\
    25262728292a3435363738393a434445464748494a535455565758595a636465666768696a737475767778797a838485868788898a9293\
    9495969798999aa2a3a4a5a6a7a8a9aab2b3b4b5b6b7b8b9bac2c3c4c5c6c7c8c9cad2d3d4d5d6d7d8d9dae1e2e3e4e5e6e7e8e9eaf1f2\
    f3f4f5f6f7f8f9faffc4001f0100030101010101010101010000000000000102030405060708090a0bffc400b511000201020404030407\
    05040400010277000102031104052131061241510761711322328108144291a1b1c109233352f0156272d10a162434e125f11718191a26\
    2728292a35363738393a434445464748494a535455565758595a636465666768696a737475767778797a82838485868788898a92939495\
    969798999aa2a3a4a5a6a7a8a9aab2b3b4b5b6b7b8b9bac2c3c4c5c6c7c8c9cad2d3d4d5d6d7d8d9dae2e3e4e5e6e7e8e9eaf2f3f4f5f6\
    f7f8f9faffda000c03010002110311003f00f88bc19ff04beff55ff14eff0077fe5d7e9fec7e838e7ad7fb9df4b7fa5a27fda76ccedfc6\
    ff0097debd39bfc8ff003b7e8c1f4e5ff9177fc2c7fcfaff0097fd34fef5adbf97a1f597833fe097dfeabfe29df4ff00975fa7fb1c7d00\
    2722bfe5ebe96ff4b46bfb4ef99ffcfed7db7af99ff45df460fa72ff00c8bbfe163fe7d7fcbff4fef792fd247fffd9";
/// `100 x + 37 y` in 12 bits.
const JPEG_LOSSLESS: &str = "ffd8ffe000104a46494600010100000100010000ffc3000b0c0008001001011100ffc40016000101010000000000000000000000000007\
    060cffda0008010100010000cffec8c8c8c8c8c8c8c8c8c8c8c8c8c8c94ac8c8c8c8c8c8c8c8c8c8c8c8c8c8c94ac8c8c8c8c8c8c8c8c8\
    c8c8c8c8c8c94ac8c8c8c8c8c8c8c8c8c8c8c8c8c8c94ac8c8c8c8c8c8c8c8c8c8c8c8c8c8c94ac8c8c8c8c8c8c8c8c8c8c8c8c8c8c94a\
    c8c8c8c8c8c8c8c8c8c8c8c8c8c8c94ac8c8c8c8c8c8c8c8c8c8c8c8c8c8c9ffd9";
/// The same with loss.
const JPEG_OF_12_BITS: &str = "ffd8ffe000104a46494600010100000100010000ffdb004300020101010101020101010202020202040302020202050404030406050606\
    0605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0affc1000b0c0008001001011100ffc4001500010100\
    000000000000000000000000000c0dffc4001c1000000603000000000000000000000000000a0b273744546172ffda0008010100003f00\
    8efa8709576206e306a73a0c804384abb1037183539d0fffd9";
/// The same in 16 bits.
const JPEG_LS: &str = "ffd8ffe800205350494646000200000100000008000000100a1006010000012c0000012cffe8000800000001ffd8fff7000b1000080010\
    01011100fff8000d01ffff0012004301140040ffda0008010100000000a63cc798b31e62d8760d7fbdddee76fb5d9ec62544a891234894\
    2a04fa793a9c5b5a595844a8955d5955514d4945413d3d396ad58891122c58ad5aa54a952952a54a85091a46a14284e9d3a74e9d3264c9\
    9324491264c9932aaaaaaaaaaaa8a28542a28a28a28a269a69a69a6a050269a69a69a69a6924924927c0ffd9";
/// The same in the high-throughput form.
const HTJ2K: &str = "ff4fff5100294000000000100000000800000000000000000000001000000008000000000000000000010f0101ff500008000200000009\
    ff52000c00020001000104044001ff5c00072088888888ff64001700014f70656e4a50482056657220302e32362e332eff90000a000000\
    00007e0001ff93c0002f4aff7f6bff6ffcb7fbdffc25fed37e57ff1bbf927fc16fde3fed0bf66e7a12fdda1fe37fd41fcabfdd47ec4ff4\
    81f94b7cfcfde01e66bfab47d36be70ff303d7afd65d0800c6420031bd00c0002aa000168846a3d1f8e60a71027600480441100441fee8\
    04207bf61081ecba00ffd9";
/// `100 x + 37 y - 800`, signed.
const J2K_SIGNED: &str = "ff4fff5100290000000000100000000800000000000000000000001000000008000000000000000000018f0101ff52000c000000010000\
    04040001ff5c00044080ff640025000143726561746564206279204f70656e4a5045472076657273696f6e20322e352e34ff90000a0000\
    000000ac0001ff93c07ed4d011500df3e02bae74d2fa7c53ce6cb6091d220cc2bf736ac8c51de93a32d46e132298cfb8633bcf63cb5752\
    b700117b6a89e919e02d11ac4e56321e55693d2dfd2b1ee905e6a344858b8eb5354cc7275441b8f46198f976941ae3525a118694d91c6c\
    7e5d2d712d07644e15493e226f2b7555ae89aaaaaad444aaab33d5ce739de6b939cf5356939ce73f543200028809000000000000000000\
    07ffd9";
/// The colours, without loss.
const J2K_COLOUR: &str = "ff4fff51002f000000000010000000080000000000000000000000100000000800000000000000000003070101070101070101ff52000c\
    00000001010004040001ff5c00044040ff640025000143726561746564206279204f70656e4a5045472076657273696f6e20322e352e34\
    ff90000a00000000013f0001ff93cfb514128eb374d01deccc3ec17a3ba0acf59a6c15000000000170c8928c2ec36db6d97836b78691cd\
    bbd6a52739ce739cb35f5dbcf4923b5b10000000000000000000000000001fdf8390140045f0c6265e983cabe5ef71650aae8a32ef69bf\
    1eea9cdd26fa33eafa1c16f154b6f08e5755a6a1b0d50978f3b1404e083baadda2657487f1652eea55a5d92057f1c7b8b4654fa197e947\
    c4c81d7c3dfcaaaaaaac126b4ae8d36e3df875ad88e3e6f9be6f9ee9bdbabbba6f6f6eaebe6fdf838841227c15b8ae09de26dbd2557d75\
    e1cd7409b6f239586c5a2a92b3ed1b6be1b8821e2254129a9be6f9be6f9a8f0043b72a675596d07d9da7609b23e5c254b3f318e0280647\
    2a21471668f5da171bc64666c5dd9353baca8322aaa887e682fbaf5ba6f6eaebe6f9be6f9be6f9be7ba6f6f7ffd9";

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2).map(|at| u8::from_str_radix(&hex[2 * at..2 * at + 2], 16).unwrap()).collect()
}

/// An empty image of 16 x 8 pixels.
fn image(syntax: &'static str, bits: u16, signed: u16, photometric: &str) -> Dicom {
    let mut dicom = Dicom::empty(syntax);
    let channels = if photometric.starts_with("MONO") { 1 } else { 3 };
    for (tag, value) in [
        (0x0028_0002, channels),
        (0x0028_0010, 8),
        (0x0028_0011, 16),
        (0x0028_0100, if bits > 8 { 16 } else { 8 }),
        (0x0028_0101, bits),
        (0x0028_0102, bits - 1),
        (0x0028_0103, signed),
    ] {
        dicom.short(tag, value);
    }
    dicom.text(0x0028_0004, b"CS", photometric);
    dicom
}

fn ramp(offset: f32) -> Vec<f32> {
    (0..128_u16).map(|at| f32::from(100 * (at % 16) + 37 * (at / 16)) + offset).collect()
}

const LOSSLESS: &str = "1.2.840.10008.1.2.4.70";
const BASELINE: &str = "1.2.840.10008.1.2.4.50";
const JPEG_LS_LOSSLESS: &str = "1.2.840.10008.1.2.4.80";
const J2K: &str = "1.2.840.10008.1.2.4.90";
const HIGH_THROUGHPUT: &str = "1.2.840.10008.1.2.4.201";

#[test]
fn packed_frames_are_read_exactly() {
    let folder = Folder::new();
    let read = |syntax, bits, signed, picture: &str| {
        let dicom = image(syntax, bits, signed, "MONOCHROME2").items(&[], &[&bytes(picture)]);
        values(&folder.read("a.dcm", dicom.file()))
    };
    assert_eq!(read(LOSSLESS, 12, 0, JPEG_LOSSLESS), ramp(0.0));
    assert_eq!(read(JPEG_LS_LOSSLESS, 16, 0, JPEG_LS), ramp(0.0));
    assert_eq!(read(HIGH_THROUGHPUT, 16, 0, HTJ2K), ramp(0.0));
    assert_eq!(read(J2K, 16, 1, J2K_SIGNED), ramp(-800.0));
    let lossy = read(BASELINE, 8, 0, JPEG);
    let worst = lossy
        .iter()
        .enumerate()
        .map(|(at, value)| (value - (8 * (at % 16) + 5 * (at / 16)) as f32).abs())
        .fold(0.0, f32::max);
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn packed_colours_are_read() {
    let folder = Folder::new();
    for (syntax, photometric, picture) in
        [(BASELINE, "YBR_FULL_422", JPEG_COLOUR), (J2K, "YBR_RCT", J2K_COLOUR)]
    {
        let volume =
            folder.read("a.dcm", image(syntax, 8, 0, photometric).items(&[], &[&bytes(picture)]).file());
        let Samples::Rgba8(colours) = volume.samples else { panic!() };
        for (at, colour) in colours.iter().enumerate() {
            let (x, y) = ((at % 16) as u8, (at / 16) as u8);
            let expected = [15 * x, 30 * y, 255 - 15 * x, 255];
            assert!(colour.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 4), "{colour:?} at {x}, {y}");
        }
    }
}

#[test]
fn frames_in_several_items_are_put_together() {
    let folder = Folder::new();
    let picture = bytes(JPEG_LOSSLESS);
    let (head, tail) = picture.split_at(100);
    let frames = |count: &str| {
        let mut dicom = image(LOSSLESS, 12, 0, "MONOCHROME2");
        dicom.text(0x0028_0008, b"IS", count);
        dicom
    };
    let two: Vec<f32> = [ramp(0.0), ramp(0.0)].concat();
    let read = |dicom: Dicom| values(&folder.read("a.dcm", dicom.file()));
    assert_eq!(read(frames("1").items(&[], &[head, tail])), ramp(0.0));
    let second = 8 + 100 + 8 + tail.len() as u32;
    // By the table, and without one by how a picture begins.
    assert_eq!(read(frames("2").items(&[0, second], &[head, tail, &picture])), two);
    assert_eq!(read(frames("2").items(&[], &[head, tail, &picture])), two);
    let mut extended = frames("2");
    extended.add(0x7fe0_0001, b"OV", &[0_u64, u64::from(second)].map(u64::to_le_bytes).concat());
    assert_eq!(read(extended.items(&[], &[head, tail, &picture])), two);
    assert!(
        folder
            .refusal("a.dcm", frames("3").items(&[], &[&picture, &picture]).file())
            .contains("fewer frames than the header says")
    );
    let unclear = frames("2").items(&[], &[head, tail, tail]).file();
    assert!(folder.refusal("a.dcm", unclear).contains("3 items make no 2 frames"));
}

#[test]
fn plain_frames_in_items_are_read() {
    let folder = Folder::new();
    let pixels: Vec<u8> = (0..128_u16).flat_map(u16::to_le_bytes).collect();
    let dicom = image("1.2.840.10008.1.2.1.98", 16, 0, "MONOCHROME2").items(&[], &[&pixels]);
    assert_eq!(folder.read("a.dcm", dicom.file()).range, (0.0, 127.0));
}

#[test]
fn what_is_not_read_names_what_does_it() {
    let folder = Folder::new();
    let refused = |syntax, bits, picture: &str| {
        folder.refusal("a.dcm", image(syntax, bits, 0, "MONOCHROME2").items(&[], &[&bytes(picture)]).file())
    };
    let twelve = refused("1.2.840.10008.1.2.4.51", 12, JPEG_OF_12_BITS);
    assert!(
        twelve.contains(
            "frame 1 of 1 (JPEG Extended): JPEG of 12 bits with loss is not read; unpack it with `dcmdjpeg"
        ),
        "{twelve}"
    );
    let video = refused("1.2.840.10008.1.2.4.102", 8, JPEG);
    assert!(
        video.contains("packed by MPEG-4 AVC/H.264 (1.2.840.10008.1.2.4.102); a video is no volume"),
        "{video}"
    );
    // Zeros are no picture of any kind.
    for syntax in [LOSSLESS, JPEG_LS_LOSSLESS, J2K, HIGH_THROUGHPUT] {
        assert!(refused(syntax, 16, &"00".repeat(64)).contains("the file is damaged"), "{syntax}");
    }
    // A picture that says another size than its file.
    let mut wide = bytes(J2K_SIGNED);
    wide[8..12].copy_from_slice(&60_000_u32.to_be_bytes());
    let wide = folder.refusal("a.dcm", image(J2K, 16, 1, "MONOCHROME2").items(&[], &[&wide]).file());
    assert!(wide.contains("it has 60000 x 8 pixels of 1, the header 16 x 8 of 1"), "{wide}");
    let mut blank = Dicom::empty(J2K);
    for (tag, value) in [(0x0028_0010, 60_000), (0x0028_0011, 60_000), (0x0028_0100, 16), (0x0028_0101, 16)] {
        blank.short(tag, value);
    }
    let blank = folder.refusal("a.dcm", blank.items(&[], &[&bytes(J2K_SIGNED)]).file());
    assert!(blank.contains("cannot hold 60000 x 60000 pixels"), "{blank}");
}

#[test]
fn damaged_pictures_never_panic() {
    for (syntax, bits, photometric, picture) in [
        (LOSSLESS, 12, "MONOCHROME2", JPEG_LOSSLESS),
        (BASELINE, 8, "YBR_FULL", JPEG_COLOUR),
        (JPEG_LS_LOSSLESS, 16, "MONOCHROME2", JPEG_LS),
        (J2K, 8, "YBR_RCT", J2K_COLOUR),
        (HIGH_THROUGHPUT, 16, "MONOCHROME2", HTJ2K),
    ] {
        let file = image(syntax, bits, 0, photometric).items(&[], &[&bytes(picture)]).file();
        mutate("a.dcm", &file, file.len());
    }
}
