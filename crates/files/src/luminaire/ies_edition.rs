//! Editions of LM-63.

/// The edition of the format, where it matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Edition {
    /// 1986, without a first line of its own.
    First,
    /// 1991.
    Second,
    /// 1995 and later.
    Later,
}

impl Edition {
    /// That of the first line with a text.
    pub(crate) fn of(line: &str) -> Self {
        let line = line.trim().to_ascii_uppercase();
        if line == "IESNA91" || line.contains("LM-63-1991") {
            Self::Second
        } else if line.contains("LM-63-") && !line.contains("LM-63-1986") {
            Self::Later
        } else {
            Self::First
        }
    }

    /// Whether the second factor is that of ballast and lamp together; later it was kept for future use, and in 2019 says how the
    /// file was made.
    pub(crate) fn has_second_factor(self) -> bool {
        match self {
            Self::First | Self::Second => true,
            Self::Later => false,
        }
    }
}
