//! What the elements of a .vti file say, one after the other.

use std::{
    io::{self, BufRead},
    path::Path,
};

use glam::{DMat3, DVec3};
use quick_xml::{XmlVersion, events::BytesStart};

use super::header::{Array, Form, Header};
use crate::sources::{
    SourceError,
    stored::{Element, StoredFormat},
    text,
    volume::Endian,
};

/// What was read so far.
pub(super) struct Reading<'a> {
    path: &'a Path,
    header: Option<Header>,
    pieces: usize,
    /// Whether arrays are of cells, where they are of either.
    of: Option<bool>,
    /// The array that the file calls its scalars.
    active: Option<String>,
    /// The array whose element is open, and how many elements are open within that.
    array: Option<(Array, usize)>,
}

impl<'a> Reading<'a> {
    /// Nothing yet.
    pub fn new(path: &'a Path) -> Self {
        Self { path, header: None, pieces: 0, of: None, active: None, array: None }
    }

    /// Something wrong with a field.
    pub fn error(&self, field: &str, problem: String) -> SourceError {
        SourceError::Field { path: self.path.to_owned(), field: field.to_owned(), problem }
    }

    fn unsupported(&self, found: String, mend: &str) -> SourceError {
        SourceError::Unsupported { path: self.path.to_owned(), found, mend: mend.to_owned() }
    }

    /// Whether a whole array was read.
    pub fn has_array(&self) -> bool {
        self.header.as_ref().is_some_and(|header| !header.arrays.is_empty())
    }

    /// What the file says so far.
    pub fn header(&mut self) -> Result<&mut Header, SourceError> {
        let error = self.error("XML", "expected `<VTKFile type=\"ImageData\">` first".to_owned());
        self.header.as_mut().ok_or(error)
    }

    /// Takes in where an element begins.
    pub fn begin(&mut self, element: &BytesStart, is_empty: bool) -> Result<(), SourceError> {
        if let Some((_, within)) = &mut self.array {
            // What is known of an array may stand beside its data.
            *within += usize::from(!is_empty);
            return Ok(());
        }
        match element.local_name().as_ref() {
            b"VTKFile" => self.header = Some(self.file(element)?),
            b"ImageData" => self.image(element)?,
            b"Piece" => {
                self.pieces += 1;
                if self.pieces > 1 {
                    return Err(
                        self.unsupported("its image is in several pieces".to_owned(), "save it in one")
                    );
                }
                let extent = self.numbers::<i64, 6>(element, "Extent")?;
                let header = self.header()?;
                header.extent = extent.map_or(header.extent, pairs);
            }
            name @ (b"PointData" | b"CellData") if !is_empty => {
                self.of = Some(name == b"CellData");
                self.active = self.active.take().or(attribute(element, "Scalars"));
            }
            b"DataArray" => {
                self.array = self.array(element)?.map(|array| (array, 0));
                if is_empty {
                    self.end(b"DataArray")?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes in where an element ends.
    pub fn end(&mut self, name: &[u8]) -> Result<(), SourceError> {
        match (self.array.take(), name) {
            (Some((array, 0)), _) => self.header()?.arrays.push(array),
            (Some((array, within)), _) => self.array = Some((array, within - 1)),
            (None, b"PointData" | b"CellData") => self.of = None,
            (None, _) => {}
        }
        Ok(())
    }

    /// Whether the data of an array may follow.
    pub fn expects_data(&self) -> bool {
        let is_open = |(array, within): &(Array, usize)| {
            *within == 0 && array.form != Form::Appended && array.span.0 == array.span.1
        };
        self.array.as_ref().is_some_and(is_open)
    }

    /// Text within the element of an array; what is blank stands in front of other elements.
    pub fn data(&mut self, start: u64, end: u64, is_blank: bool) {
        if let Some((array, _)) = self.array.as_mut().filter(|_| !is_blank) {
            array.span = (start, end);
        }
    }

    fn image(&mut self, element: &BytesStart) -> Result<(), SourceError> {
        let extent = self.numbers::<i64, 6>(element, "WholeExtent")?;
        let origin = self.numbers::<f64, 3>(element, "Origin")?.unwrap_or_default();
        let spacing = self.numbers::<f64, 3>(element, "Spacing")?.unwrap_or([1.0; 3]);
        let rows = self.numbers::<f64, 9>(element, "Direction")?;
        let header = self.header()?;
        header.extent = extent.map_or(header.extent, pairs);
        (header.origin, header.spacing) = (origin.into(), spacing.into());
        // Written row by row.
        header.direction = rows.map_or(DMat3::IDENTITY, |rows| DMat3::from_cols_array(&rows).transpose());
        Ok(())
    }

    fn file(&self, element: &BytesStart) -> Result<Header, SourceError> {
        let of = |name: &str| attribute(element, name).unwrap_or_default();
        let kind = of("type");
        if kind != "ImageData" {
            let kind: String = kind.chars().take(40).collect();
            return Err(self.unsupported(
                format!("it holds {kind}, no ImageData"),
                "resample it to an image (in ParaView: Resample To Image) and save that as .vti",
            ));
        }
        let compressor = of("compressor");
        if !matches!(&*compressor, "" | "vtkZLibDataCompressor") {
            let compressor: String = compressor.chars().take(40).collect();
            let mend = "save it with zlib, or not compressed";
            return Err(self.unsupported(format!("its data are packed by {compressor}"), mend));
        }
        Ok(Header {
            extent: [[0, -1]; 3],
            origin: DVec3::ZERO,
            spacing: DVec3::ONE,
            direction: DMat3::IDENTITY,
            endian: if of("byte_order") == "BigEndian" { Endian::Big } else { Endian::Little },
            long_lengths: of("header_type") == "UInt64",
            is_packed: !compressor.is_empty(),
            appended: None,
            arrays: Vec::new(),
        })
    }

    /// The array of an element; `None` if nothing of it can be shown.
    fn array(&self, element: &BytesStart) -> Result<Option<Array>, SourceError> {
        let Some(of_cells) = self.of else { return Ok(None) };
        let written = |name: &str| attribute(element, name);
        let format = match &*written("type").unwrap_or_default() {
            "Int8" => StoredFormat::I8,
            "UInt8" => StoredFormat::U8,
            "Int16" => StoredFormat::I16,
            "UInt16" => StoredFormat::U16,
            "Int32" => StoredFormat::I32,
            "UInt32" => StoredFormat::U32,
            "Int64" => StoredFormat::I64,
            "UInt64" => StoredFormat::U64,
            "Float32" => StoredFormat::F32,
            "Float64" => StoredFormat::F64,
            // Texts and bits.
            _ => return Ok(None),
        };
        let components =
            self.numbers::<u64, 1>(element, "NumberOfComponents")?.map_or(1, |[components]| components);
        let (form, span) = match written("format").as_deref() {
            None | Some("ascii") => (Form::Ascii, (0, 0)),
            Some("binary") => (Form::Binary, (0, 0)),
            Some("appended") => {
                let offset = self.numbers::<u64, 1>(element, "offset")?;
                let missing = || self.error("offset", "an appended array needs one".to_owned());
                (Form::Appended, (offset.ok_or_else(missing)?[0], u64::MAX))
            }
            Some(other) => {
                let other: String = other.chars().take(40).collect();
                return Err(
                    self.error("format", format!("expected ascii, binary or appended, found {other}"))
                );
            }
        };
        let name = written("Name").unwrap_or_default();
        Ok((components > 0).then_some(Array { name, format, components, of_cells, form, span }))
    }

    /// The numbers of an attribute, if it is there.
    fn numbers<T: Element, const N: usize>(
        &self,
        element: &BytesStart,
        name: &str,
    ) -> Result<Option<[T; N]>, SourceError> {
        let Some(value) = attribute(element, name) else { return Ok(None) };
        let numbers = text::numbers::<T>(&value).and_then(|numbers| <[T; N]>::try_from(numbers).ok());
        let found: String = value.chars().take(40).collect();
        numbers.map(Some).ok_or_else(|| self.error(name, format!("expected {N} numbers, found `{found}`")))
    }

    /// What the file said, the array that it calls its scalars first.
    pub fn finish(self) -> Result<Header, SourceError> {
        let path = self.path.to_owned();
        let error = self.error("XML", "it has no element VTKFile; is the file cut off?".to_owned());
        let mut header = self.header.ok_or(error)?;
        // One whose data are cut off is told as such by who reads them.
        header.arrays.extend(self.array.map(|(array, _)| array));
        if header.arrays.is_empty() {
            let mend = "save it with its point or cell data".to_owned();
            return Err(SourceError::Unsupported {
                path,
                found: "it has no array of numbers".to_owned(),
                mend,
            });
        }
        let is_active = |array: &Array| self.active.as_ref() == Some(&array.name);
        if let Some(active) = header.arrays.iter().position(is_active) {
            let active = header.arrays.remove(active);
            header.arrays.insert(0, active);
        }
        Ok(header)
    }
}

fn pairs([x, x_last, y, y_last, z, z_last]: [i64; 6]) -> [[i64; 2]; 3] {
    [[x, x_last], [y, y_last], [z, z_last]]
}

/// The value of an attribute.
pub(super) fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let attribute = element.try_get_attribute(name).ok()??;
    attribute.normalized_value(XmlVersion::Implicit1_0).ok().map(String::from)
}

/// Goes over text, up to the next element; whether there was nothing but spaces.
pub(super) fn pass_text(mut xml: impl BufRead) -> io::Result<bool> {
    let mut is_blank = true;
    loop {
        let text = xml.fill_buf()?;
        let length = text.iter().position(|byte| *byte == b'<').unwrap_or(text.len());
        is_blank &= text[..length].trim_ascii().is_empty();
        let is_over = text.is_empty() || length < text.len();
        xml.consume(length);
        if is_over {
            return Ok(is_blank);
        }
    }
}
