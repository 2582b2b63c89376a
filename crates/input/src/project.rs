//! The project that a report belongs to, with its logo read.

use crate::keys::{Key, Places};
use crate::problems::Problems;
use crate::spec::SceneSpec;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// First bytes of every PNG file (PNG specification, third edition, section 5.2).
const PNG_SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];
/// Largest logo, bytes: it is part of every page.
const LARGEST_LOGO: usize = 1_000_000;

/// The head of a report.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Project {
    /// The client.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub client: Option<String>,
    /// The author.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// The date as in the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// Number of a drawing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawing: Option<String>,
    /// A PNG file, byte for byte.
    #[serde(skip)]
    pub logo: Option<Vec<u8>>,
}

impl Project {
    /// The given entries, each with its name.
    pub fn entries(&self) -> Vec<(&'static str, &str)> {
        let all = [
            ("Client", &self.client),
            ("Author", &self.author),
            ("Date", &self.date),
            ("Drawing", &self.drawing),
        ];
        all.into_iter().filter_map(|(name, text)| Some((name, text.as_deref()?))).collect()
    }
}

/// The project of a scene; a logo that cannot be read is a problem.
pub(crate) fn project(
    spec: &SceneSpec,
    places: &Places,
    problems: &mut Problems,
) -> Option<Project> {
    let own = spec.project.as_ref()?;
    let logo = own.logo.as_ref().and_then(|file| {
        let key = Key::of(&["project", "logo"]);
        let path = places.folder(&key).join(file);
        read_logo(&path)
            .map_err(|reason| {
                problems
                    .error(&key, format!("{} {reason}", path.display()))
                    .hint("save the logo as a PNG file of at most 1 MB");
            })
            .ok()
    });
    Some(Project {
        client: own.client.clone(),
        author: own.author.clone(),
        date: own.date.clone(),
        drawing: own.drawing.clone(),
        logo,
    })
}

/// The bytes of a PNG file, or what is wrong with it.
fn read_logo(path: &Path) -> Result<Vec<u8>, String> {
    let found = std::fs::metadata(path).map_err(|reason| format!("cannot be read: {reason}"))?;
    // A pipe or a device may never end.
    if !found.is_file() {
        return Err("is not a file".to_owned());
    }
    if found.len() > LARGEST_LOGO as u64 {
        return Err(format!("has {} bytes", found.len()));
    }
    let bytes = std::fs::read(path).map_err(|reason| format!("cannot be read: {reason}"))?;
    if bytes.starts_with(&PNG_SIGNATURE) { Ok(bytes) } else { Err("is not a PNG file".to_owned()) }
}
