//! Transfer syntaxes: how a file is written, and what its pixels are packed by.

/// What unpacks a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Codec {
    /// Nothing: pixels are as they stand in memory.
    Plain,
    /// Runs of equal bytes.
    RunLength,
    /// JPEG, with or without loss.
    Jpeg,
    /// JPEG-LS.
    JpegLs,
    /// JPEG 2000, also its high-throughput form.
    Jpeg2000,
    /// Not read here: what does it instead.
    Other(&'static str),
}

/// How the file is written, by its UID.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Syntax {
    /// What the file calls it.
    pub uid: String,
    /// What people call it.
    pub name: &'static str,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
    /// Whether elements do not say their type.
    pub implicit: bool,
    /// Whether all behind the first group is one deflate stream.
    pub deflated: bool,
    /// What unpacks its pixels.
    pub codec: Codec,
}

/// What all of them begin with.
const ROOT: &str = "1.2.840.10008.1.2";

const JPEG_XL: &str = "unpack it with `dicom-transcode` of the crate dicom-pixeldata, built with its feature jpegxl, or export it again without compression";
const VIDEO: &str = "a video is no volume; take its pictures out with `gdcmraw IN VIDEO` and `ffmpeg -i VIDEO`, or name a series of images";
const REMOTE: &str = "its pixels are on a server; export it again with them";
const UNKNOWN: &str = "export it again without compression";

impl Syntax {
    /// What elements are written by that stand in front of the first that says it.
    pub fn explicit() -> Self {
        Self::of("1.2.840.10008.1.2.1")
    }

    /// The syntax of this UID. One that is not known is taken for plain, with types.
    pub fn of(uid: &str) -> Self {
        let last = uid.strip_prefix(ROOT);
        let (name, codec) = match last.unwrap_or(".1") {
            "" => ("Implicit VR Little Endian", Codec::Plain),
            ".1" => ("Explicit VR Little Endian", Codec::Plain),
            ".1.98" => ("Encapsulated Uncompressed Explicit VR Little Endian", Codec::Plain),
            ".1.99" => ("Deflated Explicit VR Little Endian", Codec::Plain),
            ".2" => ("Explicit VR Big Endian", Codec::Plain),
            ".4.50" => ("JPEG Baseline", Codec::Jpeg),
            ".4.51" => ("JPEG Extended", Codec::Jpeg),
            ".4.57" => ("JPEG Lossless", Codec::Jpeg),
            ".4.70" => ("JPEG Lossless, First-Order Prediction", Codec::Jpeg),
            ".4.80" => ("JPEG-LS Lossless", Codec::JpegLs),
            ".4.81" => ("JPEG-LS Near-Lossless", Codec::JpegLs),
            ".4.90" => ("JPEG 2000 Lossless Only", Codec::Jpeg2000),
            ".4.91" => ("JPEG 2000", Codec::Jpeg2000),
            ".4.92" => ("JPEG 2000 Part 2 Multi-component Lossless Only", Codec::Jpeg2000),
            ".4.93" => ("JPEG 2000 Part 2 Multi-component", Codec::Jpeg2000),
            ".4.94" | ".4.95" => ("JPIP Referenced", Codec::Other(REMOTE)),
            ".4.100" | ".4.100.1" | ".4.101" | ".4.101.1" => ("MPEG2", Codec::Other(VIDEO)),
            ".4.102" | ".4.102.1" | ".4.103" | ".4.103.1" | ".4.104" | ".4.104.1" | ".4.105" | ".4.105.1"
            | ".4.106" | ".4.106.1" => ("MPEG-4 AVC/H.264", Codec::Other(VIDEO)),
            ".4.107" | ".4.108" => ("HEVC/H.265", Codec::Other(VIDEO)),
            ".4.110" => ("JPEG XL Lossless", Codec::Other(JPEG_XL)),
            ".4.111" => ("JPEG XL JPEG Recompression", Codec::Other(JPEG_XL)),
            ".4.112" => ("JPEG XL", Codec::Other(JPEG_XL)),
            ".4.201" => ("High-Throughput JPEG 2000 Lossless Only", Codec::Jpeg2000),
            ".4.202" => ("High-Throughput JPEG 2000 with RPCL Options Lossless Only", Codec::Jpeg2000),
            ".4.203" => ("High-Throughput JPEG 2000", Codec::Jpeg2000),
            ".4.204" | ".4.205" => ("JPIP HTJ2K Referenced", Codec::Other(REMOTE)),
            ".5" => ("RLE Lossless", Codec::RunLength),
            // The processes of JPEG that are retired.
            last if last.strip_prefix(".4.").is_some_and(|number| number.len() == 2) => {
                ("JPEG (retired)", Codec::Jpeg)
            }
            _ => ("a transfer syntax that is not known", Codec::Other(UNKNOWN)),
        };
        Self {
            uid: uid.to_owned(),
            name,
            big_endian: last == Some(".2"),
            implicit: last == Some(""),
            deflated: last == Some(".1.99"),
            codec,
        }
    }

    /// Corrects what a file says, or does not say, by how its first element begins: old files have nothing that says it, and
    /// programs that change files forget to say it.
    pub fn seen(mut self, begin: &[u8]) -> Self {
        let &[a, b, _, _, e, f, ..] = begin else { return self };
        if self.deflated {
            return self;
        }
        // Groups are small: 8, in the byte order in which it is not 2048.
        if a != b && (a == 0 || b == 0) {
            self.big_endian = a == 0;
        }
        self.implicit = !(e.is_ascii_uppercase() && f.is_ascii_uppercase());
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn syntaxes_are_told_by_uid_and_corrected_by_what_is_seen() {
        let big = Syntax::of("1.2.840.10008.1.2.2");
        assert!(big.big_endian && !big.implicit && big.codec == Codec::Plain);
        assert_eq!(Syntax::of("1.2.840.10008.1.2.4.53").codec, Codec::Jpeg);
        assert_eq!(Syntax::of("1.2.840.10008.1.2.4.202").codec, Codec::Jpeg2000);
        assert!(matches!(Syntax::of("1.2.840.10008.1.2.4.999").codec, Codec::Other(_)));
        assert_eq!(Syntax::of("1.2.3").codec, Codec::Plain);
        assert!(Syntax::explicit().seen(&[8, 0, 0x16, 0, 26, 0, 0, 0]).implicit);
        assert!(!Syntax::of("1.2.840.10008.1.2").seen(b"\x08\0\x16\0UI\x1a\0").implicit);
        assert!(Syntax::explicit().seen(b"\0\x08\0\x16UI\0\x1a").big_endian);
    }
}
