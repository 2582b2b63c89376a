//! Seals of JSON files: a digest of everything before it, as the last key. A truncated or changed
//! file is rejected.

use lumiduct_base::digest::Digest;
use serde::de::DeserializeOwned;
use std::fmt;

/// Text before and after the digest.
const HEAD: &str = ",\n\"digest\": \"";
const TAIL: &str = "\"}\n";
/// Letters of a digest.
const DIGEST_LETTERS: usize = 16;

/// Why a file is rejected.
#[derive(Debug)]
pub enum Damage {
    /// It does not end with a digest.
    Unsealed,
    /// Its digest does not match its contents.
    Changed,
    /// It is intact, but contains something else.
    Foreign(serde_json::Error),
}

impl fmt::Display for Damage {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsealed => out
                .write_str("it was cut off, or has the layout of an older version of the program"),
            Self::Changed => {
                out.write_str("it was changed: its digest does not match its contents")
            }
            Self::Foreign(reason) => write!(out, "it holds other data: {reason}"),
        }
    }
}

/// An object in JSON with its digest.
pub fn seal(object: &str) -> String {
    let object = object.trim_end();
    let body = object.strip_suffix('}').unwrap_or(object).trim_end();
    format!("{body}{HEAD}{}{TAIL}", digest(body.as_bytes()))
}

/// The contents of a sealed file.
///
/// # Errors
///
/// [`Damage::Unsealed`] if there is no digest at the end, [`Damage::Changed`] if it is not that of the contents,
/// [`Damage::Foreign`] if the contents are not a `T` in JSON.
pub fn unseal<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Damage> {
    let body = bytes.len().checked_sub(HEAD.len() + DIGEST_LETTERS + TAIL.len());
    let (body, end) = body.map(|length| bytes.split_at(length)).ok_or(Damage::Unsealed)?;
    let found = end.strip_prefix(HEAD.as_bytes()).and_then(|end| end.strip_suffix(TAIL.as_bytes()));
    if found.ok_or(Damage::Unsealed)? != digest(body).as_bytes() {
        return Err(Damage::Changed);
    }
    serde_json::from_slice(bytes).map_err(Damage::Foreign)
}

/// The digest of some bytes: 64-bit FNV-1a, in hexadecimal.
pub(crate) fn digest(bytes: &[u8]) -> String {
    let mut digest = Digest::default();
    digest.add(bytes);
    digest.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn what_was_sealed_comes_back_and_no_byte_of_it_can_be_changed() {
        for json in [r#"{"a":1.25,"b":[3,4]}"#, "{\n  \"a\": 1.25,\n  \"b\": \"x\"\n}\n"] {
            let sealed = seal(json);
            let mut back: Value = unseal(sealed.as_bytes()).unwrap();
            back.as_object_mut().unwrap().remove("digest");
            assert_eq!(back, serde_json::from_str::<Value>(json).unwrap());
            for place in 0..sealed.len() {
                assert!(unseal::<Value>(&sealed.as_bytes()[..place]).is_err(), "cut at {place}");
                let mut changed = sealed.clone().into_bytes();
                changed[place] ^= 1;
                assert!(unseal::<Value>(&changed).is_err(), "changed at {place}");
            }
        }
        assert!(matches!(unseal::<Value>(b"{\"a\":1}\n"), Err(Damage::Unsealed)));
        assert!(matches!(unseal::<Vec<u8>>(seal("{}").as_bytes()), Err(Damage::Foreign(_))));
    }
}
