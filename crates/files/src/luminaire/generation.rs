//! How a file was made, as LM-63 says since 2019.

/// How the intensities of a file were obtained: the file generation type of LM-63-2019 (section 5.13, table 2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FileGeneration {
    /// Not known, as of all earlier files.
    #[default]
    Undefined,
    /// Computed.
    Simulated,
    /// Measured by a laboratory.
    Measured {
        /// Whether the laboratory is accredited.
        is_accredited: bool,
        /// Whether angles are others than those of the measurement.
        is_interpolated: bool,
        /// Whether intensities were scaled to another flux.
        is_scaled: bool,
    },
}

/// Steps of the number in a file: it has five decimals.
const STEPS: f64 = 1e5;
/// What the digits of a measured file add to 1, in steps: accredited, interpolated, scaled.
const DIGITS: [i64; 3] = [10_000, 1_000, 100];

impl FileGeneration {
    /// That of its number in a file; `None` if the standard has no such number.
    pub(crate) fn of_number(number: f64) -> Option<Self> {
        let steps = ((number - 1.0) * STEPS).round();
        if ((number - 1.0) * STEPS - steps).abs() > 1e-3 || !(0.0..STEPS).contains(&steps) {
            return None;
        }
        let steps = steps as i64;
        match steps {
            1 => return Some(Self::Undefined),
            10 => return Some(Self::Simulated),
            _ => {}
        }
        let digit = |place: i64| steps / place % 10;
        let [is_accredited, is_interpolated, is_scaled] = DIGITS.map(|place| digit(place) == 1);
        let own = Self::Measured { is_accredited, is_interpolated, is_scaled };
        (own.steps() == steps).then_some(own)
    }

    /// Its number in a file.
    pub(crate) fn number(self) -> String {
        format!("{:.5}", 1.0 + self.steps() as f64 / STEPS)
    }

    fn steps(self) -> i64 {
        match self {
            Self::Undefined => 1,
            Self::Simulated => 10,
            Self::Measured { is_accredited, is_interpolated, is_scaled } => {
                let all = [is_accredited, is_interpolated, is_scaled].into_iter().zip(DIGITS);
                all.map(|(is, digit)| i64::from(is) * digit).sum()
            }
        }
    }

    /// The same with angles that are others than those of a measurement.
    pub(crate) fn interpolated(self) -> Self {
        match self {
            Self::Undefined | Self::Simulated => self,
            Self::Measured { is_accredited, is_scaled, .. } => {
                Self::Measured { is_accredited, is_interpolated: true, is_scaled }
            }
        }
    }

    /// What it is called; `None` if it is not known.
    pub fn name(self) -> Option<String> {
        match self {
            Self::Undefined => None,
            Self::Simulated => Some("computed".to_owned()),
            Self::Measured { is_accredited, is_interpolated, is_scaled } => {
                let laboratory = if is_accredited { "an accredited" } else { "a" };
                let mut text = format!("measured by {laboratory} laboratory");
                if is_interpolated {
                    text += ", angles interpolated";
                }
                if is_scaled {
                    text += ", scaled to another flux";
                }
                Some(text)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_standard_and_come_back() {
        // Table 2 of LM-63-2019.
        let of = |number: &str| FileGeneration::of_number(number.parse().unwrap());
        let measured = |digits: [bool; 3]| {
            let [is_accredited, is_interpolated, is_scaled] = digits;
            Some(FileGeneration::Measured { is_accredited, is_interpolated, is_scaled })
        };
        for (number, expected) in [
            ("1.00001", Some(FileGeneration::Undefined)),
            ("1.00010", Some(FileGeneration::Simulated)),
            ("1.00000", measured([false; 3])),
            ("1.00100", measured([false, false, true])),
            ("1.01000", measured([false, true, false])),
            ("1.01100", measured([false, true, true])),
            ("1.10000", measured([true, false, false])),
            ("1.10100", measured([true, false, true])),
            ("1.11000", measured([true, true, false])),
            ("1.11100", measured([true, true, true])),
        ] {
            assert_eq!(of(number), expected, "{number}");
            assert_eq!(expected.unwrap().number(), number);
        }
        assert_eq!(of("1"), of("1.00000"));
        for wrong in ["0", "2", "1.5", "1.00002", "1.00101", "1.000001", "-1", "1e300"] {
            assert_eq!(of(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn only_measured_angles_are_interpolated() {
        let own = FileGeneration::of_number(1.1).unwrap();
        assert_eq!(own.interpolated().number(), "1.11000");
        assert!(own.interpolated().name().unwrap().contains("accredited laboratory, angles"));
        assert_eq!(FileGeneration::Simulated.interpolated(), FileGeneration::Simulated);
    }
}
