//! Units of measured values, in the names of columns.

/// Column endings whose unit is not simply what follows the last `_`.
const ENDS: [(&str, &str); 4] =
    [("_cd_m2", "cd/m²"), ("_w_m2_sr", "W/(m² sr)"), ("_w_m2", "W/m²"), ("_w_sr", "W/sr")];

/// The unit that the name of a column ends in, after `_`.
pub(super) fn unit_of_column(name: &str) -> Option<&str> {
    let lower = name.to_ascii_lowercase();
    let known = ENDS.iter().find(|(end, _)| lower.ends_with(end)).map(|(_, unit)| *unit);
    known.or_else(|| name.rsplit_once('_').map(|(_, unit)| unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns_end_in_units() {
        for (name, unit) in [
            ("luminance_cd_m2", Some("cd/m²")),
            ("L_CD_M2", Some("cd/m²")),
            ("luminance_cd/m2", Some("cd/m2")),
            ("irradiance_W_m2", Some("W/m²")),
            ("radiance_w_m2_sr", Some("W/(m² sr)")),
            ("intensity_w_sr", Some("W/sr")),
            ("illuminance_lx", Some("lx")),
            ("e", None),
        ] {
            assert_eq!(unit_of_column(name), unit, "{name}");
        }
    }
}
