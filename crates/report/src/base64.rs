//! Base64 of pictures embedded in pages and JSON files.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Digits of base64 (RFC 4648, section 4).
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// The data URI of a PNG file embedded in a page.
pub(crate) fn png_uri(bytes: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(bytes))
}

/// A file as a field of a JSON object.
pub(crate) fn serialize<S: Serializer>(bytes: &Option<Vec<u8>>, to: S) -> Result<S::Ok, S::Error> {
    bytes.as_deref().map(base64).serialize(to)
}

/// The file in a field of a JSON object.
pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<u8>>, D::Error> {
    let text: Option<String> = Deserialize::deserialize(from)?;
    let bytes = text.map(|text| bytes(&text).ok_or("is no base64")).transpose();
    bytes.map_err(serde::de::Error::custom)
}

/// Bytes as base64 with padding.
fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for part in bytes.chunks(3) {
        let byte = |place: usize| u32::from(part.get(place).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * place)) as usize & 63];
            // n bytes take n + 1 digits.
            text.push(if place <= part.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

/// The bytes of base64 with padding; `None` for any other text.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digits = text.trim_end_matches('=');
    let is_whole = text.len().is_multiple_of(4) && text.len() - digits.len() < 3;
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for part in digits.as_bytes().chunks(4) {
        let mut bits = 0;
        for place in 0..4 {
            let digit = part.get(place).map_or(Some(0), |own| DIGITS.iter().position(|d| d == own));
            bits = bits << 6 | digit? as u32;
        }
        // n + 1 digits give n bytes.
        bytes.extend(&bits.to_be_bytes()[1..part.len()]);
    }
    is_whole.then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vectors_of_rfc_4648() {
        let vectors =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (bytes, text) in vectors {
            assert_eq!(base64(bytes.as_bytes()), text);
            assert_eq!(super::bytes(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64(&[0xff, 0xef, 0xbe]), "/+++");
        for text in ["Zg", "Z===", "Zm9v!m8="] {
            assert_eq!(bytes(text), None, "{text}");
        }
    }
}
