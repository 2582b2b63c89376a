//! The position of the sun, by date, time and place.
//!
//! Low-accuracy formulas of Meeus, Astronomical Algorithms, 2nd ed. (1998): chapter 25 for the sun
//! (0.01 deg), 12 for sidereal time, 13 for the horizon, 16 for refraction at 1010 hPa and 10 °C.
//! Universal Time is used for both UT1 and Terrestrial Time: the minute between them moves the sun
//! by 0.001 deg. This module knows neither scenes nor frames.

use std::fmt;

/// Half of the apparent angle of the sun's disk at one astronomical unit, deg: a radius of 695,700
/// km (IAU 2015 resolution B3) at 149,597,870.7 km; over a year it is 0.262 to 0.271.
pub const HALF_ANGLE_DEG: f64 = 0.26645;
/// First and last year for which the formulas are trusted here.
pub(crate) const YEARS: [i32; 2] = [1900, 2100];

/// A moment, and a place on earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Days since 2000 January 1, 12:00 Universal Time.
    pub days: f64,
    /// Latitude, deg, north positive.
    pub latitude_deg: f64,
    /// Longitude, deg, east positive.
    pub longitude_deg: f64,
}

/// Apparent position of the sun's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPosition {
    /// Above the horizon, with refraction, deg.
    pub elevation_deg: f64,
    /// From north, clockwise seen from above, deg, 0 to 360.
    pub azimuth_deg: f64,
}

/// A date of the Gregorian calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Date {
    year: i32,
    month: u32,
    day: u32,
}

/// Why a date or a time could not be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Misread {
    /// It does not have the form of `2026-06-21`, or `14:30`.
    Form,
    /// There is no such day, or no such time of day.
    Missing,
    /// The year is outside `YEARS`.
    Year,
}

impl fmt::Display for Misread {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Form => write!(out, "is not understood"),
            Self::Missing => write!(out, "does not exist"),
            Self::Year => {
                let [first, last] = YEARS;
                write!(out, "has a year that is not in {first} to {last}")
            }
        }
    }
}

impl Date {
    /// Reads `2026-06-21`.
    ///
    /// # Errors
    ///
    /// [`Misread::Form`] if the text is not of this form, [`Misread::Missing`] if the calendar has no such day,
    /// [`Misread::Year`] before 1900 and after 2100.
    pub fn read(text: &str) -> Result<Self, Misread> {
        let [year, month, day] = numbers(text, '-', [4, 2, 2]).ok_or(Misread::Form)?;
        let date = Self { year: year as i32, month, day };
        let [first, last] = YEARS;
        if !(1..=12).contains(&month) || day == 0 || day > date.days_of_month() {
            return Err(Misread::Missing);
        }
        if !(first..=last).contains(&date.year) { Err(Misread::Year) } else { Ok(date) }
    }

    fn days_of_month(self) -> u32 {
        let is_leap = self.year % 4 == 0 && (self.year % 100 != 0 || self.year % 400 == 0);
        match self.month {
            2 if is_leap => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        }
    }

    /// Days from 2000 January 1, 12:00 to the start of this day: Meeus eq. (7.1), Gregorian.
    pub fn days(self) -> f64 {
        let (year, month) =
            if self.month > 2 { (self.year, self.month) } else { (self.year - 1, self.month + 12) };
        let century = year.div_euclid(100);
        let leap = 2 - century + century.div_euclid(4);
        (365.25 * f64::from(year + 4716)).floor()
            + (30.6001 * f64::from(month + 1)).floor()
            + f64::from(self.day)
            + f64::from(leap)
            - 1524.5
            - JULIAN_2000
    }
}

/// Julian date of 2000 January 1, 12:00.
const JULIAN_2000: f64 = 2_451_545.0;

/// Reads a time of day, `14:30` or `14:30:15`, in hours.
///
/// # Errors
///
/// [`Misread::Form`] if the text has neither of these forms, [`Misread::Missing`] if a day has no such time.
pub fn read_time(text: &str) -> Result<f64, Misread> {
    let [hour, minute, second] = numbers(text, ':', [2, 2, 2])
        .or_else(|| numbers(text, ':', [2, 2]).map(|[hour, minute]| [hour, minute, 0]))
        .ok_or(Misread::Form)?;
    if hour > 23 || minute > 59 || second > 59 {
        return Err(Misread::Missing);
    }
    Ok(f64::from(hour) + f64::from(minute) / 60.0 + f64::from(second) / 3600.0)
}

/// Numbers with these counts of digits and a mark between them.
fn numbers<const N: usize>(text: &str, mark: char, digits: [usize; N]) -> Option<[u32; N]> {
    let mut found = [0; N];
    let mut parts = text.split(mark);
    for (number, digits) in found.iter_mut().zip(digits) {
        let part = parts.next().filter(|part| part.len() == digits)?;
        let is_plain = part.bytes().all(|byte| byte.is_ascii_digit());
        *number = part.parse().ok().filter(|_| is_plain)?;
    }
    parts.next().is_none().then_some(found)
}

/// Apparent position of the sun, including refraction by the air; below the horizon refraction has
/// no meaning and is left out.
pub fn sun_position(observation: Observation) -> SunPosition {
    let Observation { days, latitude_deg, longitude_deg } = observation;
    let (right_ascension, declination) = equatorial(days);
    let hour_angle = (sidereal_time_deg(days) + longitude_deg).to_radians() - right_ascension;
    let latitude = latitude_deg.to_radians();
    // Meeus eq. (13.5) and (13.6), where azimuth is from the south.
    let elevation = (latitude.sin() * declination.sin()
        + latitude.cos() * declination.cos() * hour_angle.cos())
    .clamp(-1.0, 1.0)
    .asin();
    let west = hour_angle.sin() * declination.cos();
    let south =
        hour_angle.cos() * latitude.sin() * declination.cos() - declination.sin() * latitude.cos();
    let elevation_deg = elevation.to_degrees();
    SunPosition {
        elevation_deg: elevation_deg + refraction_deg(elevation_deg),
        azimuth_deg: (west.atan2(south).to_degrees() + 180.0).rem_euclid(360.0),
    }
}

/// Apparent right ascension and declination of the sun, rad: Meeus chapter 25, low accuracy.
fn equatorial(days: f64) -> (f64, f64) {
    let t = days / 36_525.0;
    let mean_longitude = 280.46646 + t * (36_000.769_83 + t * 0.000_303_2);
    let anomaly = (357.529_11 + t * (35_999.050_29 - t * 0.000_153_7)).to_radians();
    let center = (1.914_602 - t * (0.004_817 + t * 0.000_014)) * anomaly.sin()
        + (0.019_993 - t * 0.000_101) * (2.0 * anomaly).sin()
        + 0.000_289 * (3.0 * anomaly).sin();
    // Nutation and aberration.
    let node = (125.04 - 1934.136 * t).to_radians();
    let longitude = (mean_longitude + center - 0.005_69 - 0.004_78 * node.sin()).to_radians();
    // Eq. (22.2), seconds of arc as degrees, with the nutation of eq. (25.8).
    let obliquity =
        (23.439_291_1 - t * (0.013_004_2 + t * 1.64e-7) + 0.002_56 * node.cos()).to_radians();
    let right_ascension = (obliquity.cos() * longitude.sin()).atan2(longitude.cos());
    (right_ascension, (obliquity.sin() * longitude.sin()).asin())
}

/// Mean sidereal time at Greenwich, deg: Meeus eq. (12.4).
fn sidereal_time_deg(days: f64) -> f64 {
    let t = days / 36_525.0;
    (280.460_618_37 + 360.985_647_366_29 * days + t * t * 0.000_387_933).rem_euclid(360.0)
}

/// Lift of a body at this true elevation by the air, deg: Sæmundsson, Meeus eq. (16.4).
fn refraction_deg(elevation_deg: f64) -> f64 {
    // The disk is still partly visible from here on.
    if elevation_deg < -1.0 {
        return 0.0;
    }
    let argument = elevation_deg + 10.3 / (elevation_deg + 5.11);
    (1.02 / argument.to_radians().tan()).max(0.0) / 60.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn days(date: &str, hours: f64) -> f64 {
        Date::read(date).unwrap().days() + hours / 24.0
    }

    #[test]
    fn the_sun_of_1992_october_13_is_where_meeus_prints_it() {
        // Example 25.a: right ascension 198.38083 deg, declination -7.78507 deg; the exact theory
        // gives 198.378178 and -7.783872.
        let (right_ascension, declination) = equatorial(days("1992-10-13", 0.0));
        assert!((right_ascension.to_degrees().rem_euclid(360.0) - 198.38083).abs() < 1e-5);
        assert!((declination.to_degrees() + 7.78507).abs() < 1e-5);
    }

    #[test]
    fn sidereal_time_is_that_of_the_almanac() {
        // Meeus, example 12.a: 1987 April 10, 0 h: 13 h 10 min 46.3668 s.
        let expected = 15.0 * (13.0 + 10.0 / 60.0 + 46.3668 / 3600.0);
        assert!((sidereal_time_deg(days("1987-04-10", 0.0)) - expected).abs() < 1e-6);
    }

    #[test]
    fn the_position_agrees_with_the_solar_position_algorithm() {
        // Reda & Andreas, NREL/TP-560-34302 (2008), appendix A.5: Golden, Colorado, 2003 October 17, 12:30:30 at UTC - 7;
        // true elevation 39.872046 deg, azimuth 194.340241 deg.
        let hours = 12.0 + 30.5 / 60.0 + 7.0;
        let observation = Observation {
            days: days("2003-10-17", hours),
            latitude_deg: 39.742476,
            longitude_deg: -105.1786,
        };
        let SunPosition { elevation_deg, azimuth_deg } = sun_position(observation);
        let lifted = 39.872046 + refraction_deg(39.872046);
        assert!((elevation_deg - lifted).abs() < 0.01, "{elevation_deg}, {lifted}");
        assert!((azimuth_deg - 194.340241).abs() < 0.01, "{azimuth_deg}");
    }

    #[test]
    fn the_seasons_start_when_the_almanac_says() {
        // Equinox and solstice of the Astronomical Almanac, UTC: 2024 March 20, 03:06; 2026 June 21, 08:24.
        let (_, equinox) = equatorial(days("2024-03-20", 3.1));
        assert!(equinox.to_degrees().abs() < 0.005, "{}", equinox.to_degrees());
        let at = days("2026-06-21", 8.4);
        let [before, middle, after] = [-5.0, 0.0, 5.0].map(|days| equatorial(at + days).1);
        assert!(middle > before && middle > after);
        assert!((before - after).to_degrees().abs() < 0.005, "{before}, {after}");
    }

    #[test]
    fn refraction_at_the_horizon_is_about_half_a_degree() {
        // Meeus, chapter 16: about 34' for a body seen at the horizon.
        assert!((refraction_deg(-0.5667) - 0.5667).abs() < 0.02, "{}", refraction_deg(-0.5667));
        assert_eq!(refraction_deg(90.0), 0.0);
        assert_eq!(refraction_deg(-20.0), 0.0);
    }

    #[test]
    fn days_and_times_that_do_not_exist_are_refused() {
        for text in ["2025-02-29", "2026-13-01", "2026-04-31", "2026-00-10", "2026-01-00"] {
            assert_eq!(Date::read(text), Err(Misread::Missing), "{text}");
        }
        for text in ["26-06-21", "2026/06/21", "2026-6-21", "2026-06-21-1", "+026-01-01", ""] {
            assert_eq!(Date::read(text), Err(Misread::Form), "{text}");
        }
        assert_eq!(Date::read("1492-10-12"), Err(Misread::Year));
        assert!(Date::read("2024-02-29").is_ok());
        assert_eq!(read_time("24:00"), Err(Misread::Missing));
        assert_eq!(read_time("noon"), Err(Misread::Form));
        assert_eq!(read_time("06:30:36"), Ok(6.51));
    }
}
