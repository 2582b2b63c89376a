//! The bytes behind a glTF document: the blob of a GLB, data URIs and external files; the bounds of
//! accessors are checked once, before anything is read.

use crate::bytes::read_file;
use crate::mesh::error::{MAX_FILE_BYTES, MeshError};
use crate::mesh::format::MeshFormat;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};
use std::borrow::Cow;
use std::path::Path;

/// All buffers of a document.
pub(crate) struct Buffers<'a> {
    root: &'a Root,
    bytes: Vec<Cow<'a, [u8]>>,
}

/// The elements of an accessor; every element lies within the bytes.
#[derive(Clone, Copy)]
pub(crate) struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The bytes of one element, if it exists.
    pub(crate) fn get(&self, index: usize) -> Option<&'a [u8]> {
        let start = (index < self.count).then_some(index * self.stride)?;
        self.bytes.get(start..start + self.size)
    }
}

impl<'a> Buffers<'a> {
    /// Loads every buffer; `blob` is the binary chunk of a GLB, `folder` the place of the document.
    pub(crate) fn load(
        root: &'a Root,
        blob: Option<&'a [u8]>,
        folder: &Path,
    ) -> Result<Self, MeshError> {
        let mut bytes = Vec::with_capacity(root.buffers.len());
        let mut room = MAX_FILE_BYTES;
        for (index, buffer) in root.buffers.iter().enumerate() {
            let data = match (&buffer.uri, blob) {
                (Some(uri), _) => Cow::Owned(load_uri(uri, folder, room)?),
                (None, Some(blob)) if index == 0 => Cow::Borrowed(blob),
                (None, _) => return Err(broken(format!("buffer {index} has no data"))),
            };
            if (data.len() as u64) < buffer.byte_length.0 {
                return Err(broken(format!(
                    "buffer {index} announces {} bytes and holds {}",
                    buffer.byte_length.0,
                    data.len()
                )));
            }
            room = room.saturating_sub(data.len() as u64);
            bytes.push(data);
        }
        Ok(Self { root, bytes })
    }

    /// The elements of an accessor that must be of `shape`, and the type of their components.
    pub(crate) fn elements(
        &self,
        index: Index<Accessor>,
        shape: Type,
    ) -> Result<(Elements<'_>, ComponentType), MeshError> {
        let number = index.value();
        let missing =
            |what: &str| broken(format!("accessor {number} {what}, or that does not exist"));
        let accessor = self.root.get(index).ok_or_else(|| missing("is asked for"))?;
        if accessor.sparse.is_some() {
            return Err(MeshError::Unsupported {
                what: format!("accessor {number} of the glTF file is sparse"),
                remedy: "export without sparse accessors",
            });
        }
        let (Checked::Valid(type_), Checked::Valid(component)) =
            (accessor.type_, accessor.component_type)
        else {
            return Err(broken(format!("accessor {number} has an unknown type")));
        };
        if type_ != shape {
            return Err(broken(format!("accessor {number} is a {type_:?}, expected {shape:?}")));
        }
        let view = accessor.buffer_view.and_then(|view| self.root.get(view));
        let view = view.ok_or_else(|| missing("needs a buffer view"))?;
        let buffer = self.bytes.get(view.buffer.value());
        let buffer = buffer.ok_or_else(|| missing("needs a buffer"))?;
        let size = component.0.size() * shape.multiplicity();
        let elements =
            slice(buffer, view.byte_offset.map_or(0, |offset| offset.0), view.byte_length.0)
                .and_then(|bytes| {
                    let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                    let bytes = slice(bytes, offset, (bytes.len() as u64).checked_sub(offset)?)?;
                    let stride = view.byte_stride.map_or(size, |stride| stride.0);
                    let count = usize::try_from(accessor.count.0).ok()?;
                    fits(bytes.len(), count, stride, size).then_some(Elements {
                        bytes,
                        stride,
                        size,
                        count,
                    })
                })
                .ok_or_else(|| broken(format!("accessor {number} reaches beyond its buffer")))?;
        Ok((elements, component.0))
    }
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}

/// Whether `count` elements lie within `length` bytes without overlapping.
fn fits(length: usize, count: usize, stride: usize, size: usize) -> bool {
    let end = count.saturating_sub(1).checked_mul(stride).and_then(|last| last.checked_add(size));
    count == 0 || (stride >= size && end.is_some_and(|end| end <= length))
}

fn load_uri(uri: &str, folder: &Path, room: u64) -> Result<Vec<u8>, MeshError> {
    if let Some(data) = uri.strip_prefix("data:") {
        return data
            .split_once(";base64,")
            .and_then(|(_, text)| decode_base64(text))
            .ok_or_else(|| broken("a data URI is not valid base64".into()));
    }
    let refused =
        || broken(format!("the buffer `{uri}` is not a file name relative to the document"));
    let name = decode_percent(uri).ok_or_else(refused)?;
    if name.contains(':') || Path::new(&name).is_absolute() {
        return Err(refused());
    }
    let unreadable = |source| MeshError::BufferFile { uri: uri.to_owned(), source };
    read_file(&folder.join(name), room).map_err(unreadable)?.ok_or(MeshError::FileTooLong)
}

/// RFC 4648 section 4, with or without padding.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() * 3 / 4);
    for group in text.chunks(4) {
        let mut bits = 0u32;
        for (place, character) in group.iter().enumerate() {
            bits |= u32::from(base64_digit(*character)?) << (26 - 6 * place);
        }
        match group.len() {
            4 => bytes.extend_from_slice(&bits.to_be_bytes()[..3]),
            3 => bytes.extend_from_slice(&bits.to_be_bytes()[..2]),
            2 => bytes.extend_from_slice(&bits.to_be_bytes()[..1]),
            _ => return None,
        }
    }
    Some(bytes)
}

fn base64_digit(character: u8) -> Option<u8> {
    match character {
        b'A'..=b'Z' => Some(character - b'A'),
        b'a'..=b'z' => Some(character - b'a' + 26),
        b'0'..=b'9' => Some(character - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}

/// RFC 3986 section 2.1.
fn decode_percent(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        if *first == b'%' {
            let digits = std::str::from_utf8(after.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &after[2..];
        } else {
            bytes.push(*first);
            rest = after;
        }
    }
    String::from_utf8(bytes).ok()
}

/// An error about the document.
pub(crate) fn broken(problem: String) -> MeshError {
    MeshError::Broken { format: MeshFormat::Gltf, problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_length_is_decoded_and_rubbish_refused() {
        // RFC 4648 section 10.
        for (text, expected) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(decode_base64(text).unwrap(), expected.as_bytes());
        }
        assert_eq!(decode_base64("Z"), None);
        assert_eq!(decode_base64("Zm9*"), None);
    }

    #[test]
    fn elements_that_reach_beyond_overlap_or_overflow_do_not_fit() {
        assert!(fits(36, 3, 12, 12));
        assert!(fits(32, 2, 20, 12));
        assert!(fits(0, 0, 0, 12));
        assert!(!fits(35, 3, 12, 12));
        assert!(!fits(36, 3, 4, 12));
        assert!(!fits(36, usize::MAX, 12, 12));
        assert!(!fits(36, 2, usize::MAX, 12));
    }

    #[test]
    fn percent_signs_are_decoded() {
        assert_eq!(decode_percent("light%20guide.bin").unwrap(), "light guide.bin");
        assert_eq!(decode_percent("a%2"), None);
        assert_eq!(decode_percent("a%zz"), None);
        assert_eq!(decode_percent("a%ff"), None);
    }
}
