//! The chromaticity of light: its colour without its amount (CIE 015:2018).

/// The chromaticity coordinates of light for a standard observer, CIE 1931 unless something else is said, 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chromaticity {
    /// x = X / (X + Y + Z).
    pub x: f64,
    /// y = Y / (X + Y + Z).
    pub y: f64,
}

impl Chromaticity {
    /// The equal-energy stimulus E.
    pub const EQUAL_ENERGY: Self = Self { x: 1.0 / 3.0, y: 1.0 / 3.0 };

    /// The chromaticity of tristimulus values X, Y, Z in any common unit; `None` if their sum is not a positive number.
    pub fn from_tristimulus([x, y, z]: [f64; 3]) -> Option<Self> {
        let sum = x + y + z;
        (sum > 0.0 && sum.is_finite()).then(|| Self { x: x / sum, y: y / sum })
    }

    /// The coordinates u', v' of the CIE 1976 uniform chromaticity scale diagram, 1 (ISO/CIE 11664-5:2016).
    pub fn uv_1976(self) -> [f64; 2] {
        let denominator = 3.0 - 2.0 * self.x + 12.0 * self.y;
        [4.0 * self.x / denominator, 9.0 * self.y / denominator]
    }

    /// The chromaticity with these coordinates u', v', 1; the inverse of [`Self::uv_1976`].
    pub fn from_uv_1976([u, v]: [f64; 2]) -> Self {
        let denominator = 6.0 * u - 16.0 * v + 12.0;
        Self { x: 9.0 * u / denominator, y: 4.0 * v / denominator }
    }

    /// Tristimulus values X, Y, Z of light of this chromaticity, in the unit of Y.
    pub fn tristimulus(self, luminous: f64) -> [f64; 3] {
        [self.x / self.y, 1.0, (1.0 - self.x - self.y) / self.y].map(|own| luminous * own)
    }

    /// The coordinates u, v of the CIE 1960 uniform chromaticity scale diagram, 1: u = u', v = 2/3 v'. Colour temperature
    /// and colour rendering still use it.
    pub fn uv_1960(self) -> [f64; 2] {
        let [u, v] = self.uv_1976();
        [u, v * 2.0 / 3.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_illuminant_a_agree_with_the_published_ones() {
        // CIE 015:2018, standard illuminant A: X 109.85, Y 100, Z 35.58; x 0.44758, y 0.40745; u' 0.25597, v' 0.52429.
        let own = Chromaticity::from_tristimulus([109.85, 100.0, 35.58]).unwrap();
        assert!((own.x - 0.44758).abs() < 1e-5 && (own.y - 0.40745).abs() < 1e-5, "{own:?}");
        let [u, v] = own.uv_1976();
        assert!((u - 0.25597).abs() < 1e-5 && (v - 0.52429).abs() < 1e-5, "{u} {v}");
    }

    #[test]
    fn the_diagrams_agree_with_an_independent_program() {
        // colour-science 0.4.7, xy_to_UCS_uv.
        for (x, y, u, v) in
            [(0.3127, 0.3290, 0.19783001, 0.31221333), (0.57, 0.39, 0.34862385, 0.35779817)]
        {
            let [own_u, own_v] = Chromaticity { x, y }.uv_1960();
            assert!((own_u - u).abs() < 1e-8 && (own_v - v).abs() < 1e-8, "{own_u} {own_v}");
        }
    }

    #[test]
    fn stimuli_have_their_chromaticity_in_either_diagram() {
        let own = Chromaticity { x: 0.44758, y: 0.40745 };
        let found = Chromaticity::from_uv_1976(own.uv_1976());
        assert!((found.x - own.x).abs() < 1e-15 && (found.y - own.y).abs() < 1e-15, "{found:?}");
        // Illuminant A: X 109.85, Z 35.58 for Y 100.
        let [x, y, z] = own.tristimulus(100.0);
        assert!((x - 109.85).abs() < 0.01 && y == 100.0 && (z - 35.58).abs() < 0.01, "{x} {z}");
    }

    #[test]
    fn no_light_has_no_chromaticity() {
        for values in
            [[0.0; 3], [f64::NAN, 1.0, 1.0], [f64::INFINITY, 1.0, 1.0], [-1.0, -1.0, -1.0]]
        {
            assert_eq!(Chromaticity::from_tristimulus(values), None);
        }
    }
}
