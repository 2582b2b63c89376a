//! Files with what was counted so far: checkpoints, and slices of a run.
//!
//! A file has a line that names its kind, the length of the contents, the contents (postcard), and
//! their digest. So a file that is truncated, changed or of another kind is recognised before its
//! contents are used.

use crate::pipeline::version::BUILD;
use lumiduct_base::digest::Digest;
use lumiduct_base::error::{Error, Result};
use lumiduct_report::{Existing, write_whole};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::path::Path;

/// Kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SnapshotKind {
    /// The state of a run.
    Checkpoint,
    /// What was counted in some of the batches of a run.
    Slice,
}

impl SnapshotKind {
    fn name(self) -> &'static str {
        match self {
            Self::Checkpoint => "checkpoint",
            Self::Slice => "slice",
        }
    }

    /// What to do about a file that cannot be used.
    fn remedy(self) -> &'static str {
        match self {
            Self::Checkpoint => "to start again, give --overwrite in place of --resume",
            Self::Slice => "trace the part again, with --overwrite",
        }
    }

    /// The first line of a file. The number is the version of its layout; the build of the program
    /// is part of the contents.
    fn line(self) -> String {
        format!("lumiduct {} 2\n", self.name())
    }
}

/// Bytes of the length before the contents, and of the digest after them.
const LENGTH_BYTES: usize = 8;
const DIGEST_BYTES: usize = 16;

/// Writes a file, whole or not at all.
pub(super) fn write(path: &Path, kind: SnapshotKind, contents: &impl Serialize) -> Result<()> {
    let contents = postcard::to_stdvec(&(BUILD, contents))
        .map_err(|reason| Error::Output { what: kind.name().into(), reason: reason.to_string() })?;
    write_whole(path, &framed(kind, &contents), Existing::Replace)
}

/// Contents between their line and length and their digest.
fn framed(kind: SnapshotKind, contents: &[u8]) -> Vec<u8> {
    let mut bytes = kind.line().into_bytes();
    bytes.extend((contents.len() as u64).to_le_bytes());
    bytes.extend(contents);
    bytes.extend(digest(contents).as_bytes());
    bytes
}

/// Reads a file, or reports what is wrong with it.
pub(super) fn read<T: DeserializeOwned>(path: &Path, kind: SnapshotKind) -> Result<T> {
    let bytes = fs::read(path).map_err(|source| Error::io(path, source))?;
    let refuse = |why: &str| {
        let (path, name, remedy) = (path.display(), kind.name(), kind.remedy());
        Error::Usage(format!("{path} is not a usable {name}: {why}; {remedy}"))
    };
    let line = kind.line();
    let rest = bytes
        .strip_prefix(line.as_bytes())
        .ok_or_else(|| refuse("it does not begin like one of this version of the program"))?;
    let (length, rest) =
        rest.split_at_checked(LENGTH_BYTES).ok_or_else(|| refuse("it was cut off"))?;
    let length = length.iter().rev().fold(0u64, |sum, byte| sum << 8 | u64::from(*byte));
    if rest.len() as u64 != length.saturating_add(DIGEST_BYTES as u64) {
        return Err(refuse(&format!(
            "it was cut off, or something was added: {} bytes instead of {length}",
            rest.len().saturating_sub(DIGEST_BYTES)
        )));
    }
    let (contents, found) = rest.split_at(rest.len() - DIGEST_BYTES);
    if digest(contents).as_bytes() != found {
        return Err(refuse("it was changed: its digest does not match its contents"));
    }
    let (build, contents): (String, _) = postcard::take_from_bytes(contents)
        .map_err(|_| refuse("it is from another version of the program"))?;
    if build != BUILD {
        return Err(refuse(&format!(
            "it is from another build of the program, {build}, and this is {BUILD}; use that build"
        )));
    }
    postcard::from_bytes(contents).map_err(|_| refuse("it holds other data"))
}

fn digest(contents: &[u8]) -> String {
    let mut digest = Digest::default();
    digest.add(contents);
    digest.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &Path, bytes: &[u8]) -> String {
        fs::write(path, bytes).unwrap();
        read::<Vec<f64>>(path, SnapshotKind::Checkpoint).unwrap_err().to_string()
    }

    #[test]
    fn what_was_written_comes_back_to_the_bit_and_nothing_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint.bin");
        let numbers = vec![0.1, f64::MIN_POSITIVE, f64::INFINITY, -0.0];
        write(&path, SnapshotKind::Checkpoint, &numbers).unwrap();
        let bytes = fs::read(&path).unwrap();
        let read: Vec<f64> = read(&path, SnapshotKind::Checkpoint).unwrap();
        assert!(read.iter().zip(&numbers).all(|(a, b)| a.to_bits() == b.to_bits()));

        for cut in 0..bytes.len() {
            let text = refused(&path, &bytes[..cut]);
            assert!(text.contains("cut off") || text.contains("does not begin"), "{cut}: {text}");
        }
        for place in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[place] ^= 1;
            refused(&path, &changed);
        }
        write(&path, SnapshotKind::Slice, &numbers).unwrap();
        let slice = fs::read(&path).unwrap();
        assert!(refused(&path, &slice).contains("does not begin"));
        write(&path, SnapshotKind::Checkpoint, &"other contents").unwrap();
        let other = fs::read(&path).unwrap();
        assert!(refused(&path, &other).contains("other data"));
        let foreign = postcard::to_stdvec(&("0.0.9+1", &numbers)).unwrap();
        fs::write(&path, framed(SnapshotKind::Checkpoint, &foreign)).unwrap();
        let said =
            super::read::<Vec<f64>>(&path, SnapshotKind::Checkpoint).unwrap_err().to_string();
        assert!(said.contains("another build of the program, 0.0.9+1"), "{said}");
    }
}
