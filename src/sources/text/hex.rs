//! Bytes written out as pairs of hexadecimal digits.

use std::io::{self, BufRead, Read};

/// Turns pairs of hexadecimal digits into bytes.
pub(in crate::sources) struct HexReader<R> {
    reader: R,
}

impl<R: BufRead> HexReader<R> {
    /// Bytes of the digits that `reader` holds.
    pub fn new(reader: R) -> Self {
        Self { reader }
    }

    fn digit(&mut self) -> io::Result<Option<u8>> {
        loop {
            let Some(&byte) = self.reader.fill_buf()?.first() else { return Ok(None) };
            self.reader.consume(1);
            if !byte.is_ascii_whitespace() {
                let digit = char::from(byte).to_digit(16);
                let digit = digit.ok_or_else(|| {
                    io::Error::new(io::ErrorKind::InvalidData, "expected a hexadecimal digit")
                })?;
                return Ok(Some(digit as u8));
            }
        }
    }
}

impl<R: BufRead> Read for HexReader<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        for (filled, byte) in bytes.iter_mut().enumerate() {
            match (self.digit()?, self.digit()?) {
                (Some(high), Some(low)) => *byte = high << 4 | low,
                (None, _) => return Ok(filled),
                (Some(_), None) => return Err(io::ErrorKind::UnexpectedEof.into()),
            }
        }
        Ok(bytes.len())
    }
}
