//! The few fields of a NIfTI-1 file that it takes to turn its image into a raw volume.
//!
//! Header: <https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h>.

use anyhow::{Context, Result, bail, ensure};

/// A volume, x fastest, little-endian.
#[derive(Debug)]
pub struct Image {
    pub size: [usize; 3],
    /// Between voxels, in millimetres.
    pub spacing: [f32; 3],
    /// As scenes name it: `U8` or `I16`.
    pub format: &'static str,
    pub voxels: Vec<u8>,
}

const HEADER_BYTES: usize = 348;

/// Reads one image of 8-bit or 16-bit integers.
pub fn parse(nifti: &[u8]) -> Result<Image> {
    let header = Header::new(nifti)?;
    let size = [42, 44, 46].map(|at| usize::try_from(header.i16(at)).unwrap_or(0));
    let dimensions = header.i16(40);
    ensure!(
        dimensions == 3 || (dimensions == 4 && header.i16(48) == 1),
        "{dimensions} dimensions, not one volume"
    );
    let (format, bytes_each) = match header.i16(70) {
        2 => ("U8", 1),
        4 => ("I16", 2),
        other => bail!("voxels of NIfTI type {other}; only 8-bit (2) and 16-bit (4) integers are read"),
    };
    let (slope, intercept) = (header.f32(112), header.f32(116));
    ensure!(
        slope == 0.0 || (slope == 1.0 && intercept == 0.0),
        "voxels are scaled by {slope} and {intercept}"
    );

    let bytes = size.iter().product::<usize>() * bytes_each;
    let start = header.f32(108) as usize;
    let found = nifti.len().saturating_sub(start);
    let voxels = nifti.get(start..start + bytes);
    let mut voxels =
        voxels.with_context(|| format!("{found} bytes of voxels, where {size:?} need {bytes}"))?.to_vec();
    if bytes_each == 2 && header.big_endian {
        voxels.chunks_exact_mut(2).for_each(<[u8]>::reverse);
    }
    Ok(Image { size, spacing: [80, 84, 88].map(|at| header.f32(at)), format, voxels })
}

/// Fields by their offset, in the byte order of the file.
struct Header<'a> {
    bytes: &'a [u8; HEADER_BYTES],
    big_endian: bool,
}

impl<'a> Header<'a> {
    fn new(nifti: &'a [u8]) -> Result<Self> {
        let bytes: &[u8; HEADER_BYTES] = nifti.first_chunk().context("too short for a NIfTI-1 header")?;
        ensure!(bytes.ends_with(b"n+1\0"), "not a NIfTI-1 file of header and image in one");
        // The header's size comes first, and so tells the byte order.
        let size = [bytes[0], bytes[1], bytes[2], bytes[3]];
        let big_endian = u32::from_be_bytes(size) as usize == HEADER_BYTES;
        ensure!(big_endian || u32::from_le_bytes(size) as usize == HEADER_BYTES, "not a NIfTI-1 header");
        Ok(Self { bytes, big_endian })
    }

    fn i16(&self, at: usize) -> i16 {
        let bytes = [self.bytes[at], self.bytes[at + 1]];
        if self.big_endian { i16::from_be_bytes(bytes) } else { i16::from_le_bytes(bytes) }
    }

    fn f32(&self, at: usize) -> f32 {
        let bytes = std::array::from_fn(|byte| self.bytes[at + byte]);
        if self.big_endian { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two voxels, 1 and 2, of 16 bits each.
    fn image(big_endian: bool) -> Vec<u8> {
        let mut file = vec![0; 352];
        let mut put = |at: usize, little: &[u8]| {
            let bytes: Vec<u8> =
                if big_endian { little.iter().rev().copied().collect() } else { little.to_vec() };
            file.splice(at..(at + bytes.len()).min(file.len()), bytes);
        };
        put(0, &348_u32.to_le_bytes());
        for (at, value) in [(40, 3_i16), (42, 2), (44, 1), (46, 1), (70, 4)] {
            put(at, &value.to_le_bytes());
        }
        for (at, value) in [(80, 1.5_f32), (84, 1.0), (88, 2.0), (108, 352.0)] {
            put(at, &value.to_le_bytes());
        }
        put(352, &1_i16.to_le_bytes());
        put(354, &2_i16.to_le_bytes());
        file[344..348].copy_from_slice(b"n+1\0");
        file
    }

    #[test]
    fn both_byte_orders_are_read() {
        for big_endian in [false, true] {
            let image = parse(&image(big_endian)).unwrap();
            assert_eq!((image.size, image.spacing, image.format), ([2, 1, 1], [1.5, 1.0, 2.0], "I16"));
            assert_eq!(image.voxels, [1, 0, 2, 0]);
        }
    }

    #[test]
    fn what_is_missing_is_said() {
        let mut cut = image(false);
        cut.pop();
        assert_eq!(parse(&cut).unwrap_err().to_string(), "3 bytes of voxels, where [2, 1, 1] need 4");
        let mut floats = image(false);
        floats[70] = 16;
        assert!(parse(&floats).unwrap_err().to_string().contains("type 16"));
        assert!(parse(b"short").is_err());
    }
}
