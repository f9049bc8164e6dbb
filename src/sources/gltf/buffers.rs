//! The bytes that a glTF document names.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::io::Read;
use std::path::Path;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json;
use percent_encoding::percent_decode_str;

use super::MAX_GLTF_BYTES;
use crate::sources::mesh::quoted;
use crate::sources::{SourceError, file};

/// Base64 with or without `=` at its end.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

type Bytes<'a> = Result<Cow<'a, [u8]>, String>;

/// The buffers of a document, each read when it is first needed.
pub(super) struct Buffers<'a> {
    path: &'a Path,
    root: &'a json::Root,
    binary: Option<&'a [u8]>,
    read: Vec<OnceCell<Bytes<'a>>>,
}

impl<'a> Buffers<'a> {
    pub fn new(path: &'a Path, root: &'a json::Root, binary: Option<&'a [u8]>) -> Self {
        Self { path, root, binary, read: root.buffers.iter().map(|_| OnceCell::new()).collect() }
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: json::Index<json::buffer::View>) -> Result<&[u8], String> {
        let place = index.value();
        let view = self.root.get(index).ok_or_else(|| format!("there is no buffer view {place}"))?;
        let buffer = self.buffer(view.buffer.value())?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let end = start.checked_add(view.byte_length.0);
        let range = end.and_then(|end| Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        range.and_then(|range| buffer.get(range)).ok_or_else(|| {
            let (length, there) = (view.byte_length.0, buffer.len());
            format!("buffer view {place} of {length} bytes at {start} ends outside of its buffer of {there}")
        })
    }

    fn buffer(&self, index: usize) -> Result<&[u8], String> {
        let cell = self.read.get(index).ok_or_else(|| format!("there is no buffer {index}"))?;
        let bytes = cell.get_or_init(|| {
            let buffer = &self.root.buffers[index];
            let bytes = match (&buffer.uri, self.binary) {
                (Some(uri), _) => self.resource(uri)?,
                (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
                (None, _) => return Err("it names no file, and none is inside".to_owned()),
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let (there, length) = (bytes.len(), buffer.byte_length.0);
                return Err(format!("{there} bytes; it should have {length}: it is cut off"));
            }
            Ok(bytes)
        });
        bytes.as_deref().map_err(|problem| format!("buffer {index}: {problem}"))
    }

    /// The bytes behind a URI: in it, or in a file beside the document.
    pub fn resource(&self, uri: &str) -> Result<Cow<'a, [u8]>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (kind, data) = data.split_once(',').ok_or("a `data:` URI without a comma")?;
            if !kind.ends_with(";base64") {
                return Ok(Cow::Owned(percent_decode_str(data).collect()));
            }
            let text: Vec<u8> = percent_decode_str(data).filter(|byte| !byte.is_ascii_whitespace()).collect();
            return BASE64
                .decode(text)
                .map(Cow::Owned)
                .map_err(|error| format!("its base64 is wrong: {error}"));
        }
        if uri
            .split_once(':')
            .is_some_and(|(scheme, _)| scheme.len() > 1 && scheme.chars().all(|c| c.is_ascii_alphanumeric()))
        {
            return Err(format!("`{}` is no file beside it", quoted(uri)));
        }
        let name = percent_decode_str(uri).decode_utf8_lossy().into_owned();
        let folder = self.path.parent().unwrap_or(Path::new(""));
        // Names that are not encoded, although they ought to be, occur as well.
        let written = folder.join(uri);
        let path = if written.is_file() { written } else { folder.join(name) };
        let without_path = |error: SourceError| error.to_string();
        let (file, bytes) = file::open(&path).map_err(without_path)?;
        if bytes > MAX_GLTF_BYTES {
            return Err(format!("`{}` has {bytes} bytes; at most {MAX_GLTF_BYTES} are read", quoted(uri)));
        }
        let mut content = Vec::new();
        file.take(MAX_GLTF_BYTES).read_to_end(&mut content).map_err(|cause| cause.to_string())?;
        Ok(Cow::Owned(content))
    }
}
