//! Reading of untrusted files, of limited length.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

/// All bytes of a regular file; `None` if there are more than `limit`.
pub(crate) fn read_file(path: &Path, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let about = fs::metadata(path)?;
    // A pipe or a device may never end.
    if !about.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    if about.len() > limit {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    // It may have grown.
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// What is wrong with a text that is not UTF-8.
pub(crate) const NOT_UTF8: &str = "it is not UTF-8 text; save it as UTF-8";

/// The text of a file, without a byte order mark; the line, from 1, of what is not UTF-8.
pub(crate) fn utf8(bytes: &[u8]) -> Result<&str, usize> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        1 + before.iter().filter(|byte| **byte == b'\n').count()
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// The first of some columns that a table names twice, whatever the case of its letters.
pub(crate) fn repeated<'a>(names: &[&str], columns: &[&'a str]) -> Option<&'a str> {
    let count = |column: &str| names.iter().filter(|own| own.eq_ignore_ascii_case(column)).count();
    columns.iter().copied().find(|column| count(column) > 1)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};
    use rand_xoshiro::SplitMix64;

    /// `count` damaged copies of a file: bytes changed, removed or duplicated, or the end missing.
    pub(crate) fn mutants(original: &[u8], count: u64, seed: u64) -> impl Iterator<Item = Vec<u8>> {
        (0..count).map(move |index| {
            let mut random = SplitMix64::seed_from_u64(seed << 32 | index);
            let mut below = |n: usize| (random.next_u64() % n as u64) as usize;
            let mut bytes = original.to_vec();
            for _ in 0..=below(8) {
                if bytes.is_empty() {
                    break;
                }
                let at = below(bytes.len());
                let end = (at + 1 + below(12)).min(bytes.len());
                match below(6) {
                    0 => bytes[at] = below(256) as u8,
                    1 => bytes[at] ^= 1 << below(8),
                    2 => bytes[at..end].fill([0x00, 0x7f, 0xff, b'9', b'-'][below(5)]),
                    3 => drop(bytes.drain(at..end)),
                    4 => bytes.extend_from_within(at..end),
                    _ => bytes.truncate(at + (bytes.len() - at) * below(4) / 3),
                }
            }
            bytes
        })
    }

    #[test]
    fn a_missing_file_a_folder_and_a_long_file_are_not_read() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path(), &folder.path().join("missing.stl")] {
            assert!(read_file(path, 1000).is_err());
        }
        let path = folder.path().join("long.stl");
        fs::write(&path, [0; 100]).unwrap();
        assert_eq!(read_file(&path, 99).unwrap(), None);
        assert_eq!(read_file(&path, 100).unwrap().unwrap().len(), 100);
    }
}
