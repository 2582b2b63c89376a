//! The pixels of an image: directions behind a lens without distortion.
//!
//! A plane at distance 1 in front of the aperture is divided into equal squares, like the sensor
//! behind a lens, so straight lines of the scene are straight in the image. A point in that plane
//! is a pair of tangents. This module does not know the aperture.

use crate::scene::Grid;
use crate::scene::shape::ChartRect;
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;

/// The pixels of an imaging luminance meter.
#[derive(Debug, Clone)]
pub struct Pixels {
    /// To the right as seen from the aperture, unit vector.
    right: DVec3,
    /// Up, unit vector.
    up: DVec3,
    /// Along the view, unit vector.
    axis: DVec3,
    /// The pixels over the tangents of the angles to the right and up, 1.
    pub grid: Grid,
    /// Projected solid angle of each pixel on the aperture, sr.
    pub projected: Vec<f64>,
}

impl Pixels {
    /// An image of `columns` by `rows` in which a pixel in the middle would subtend the angle
    /// `pixel`, rad. It looks along the z of `frame`, with y up and, because the view is along z, x
    /// to the left.
    pub fn new(frame: &Frame, [columns, rows]: [usize; 2], pixel: f64) -> Self {
        let pitch = 2.0 * (0.5 * pixel).tan();
        let half = 0.5 * pitch * DVec2::new(columns as f64, rows as f64);
        let rect = ChartRect { min: -half, max: half };
        let grid = Grid::Cartesian { rect, nu: columns, nv: rows };
        let projected = grid.cell_areas(projected_rectangle);
        Self { right: -frame.x, up: frame.y, axis: frame.z, grid, projected }
    }

    /// Number of pixels.
    pub(crate) fn count(&self) -> usize {
        self.grid.cells()
    }

    /// The pixel that sees light from the direction `away`, a unit vector away from the aperture.
    #[inline]
    pub(crate) fn pixel(&self, away: DVec3) -> Option<usize> {
        let depth = away.dot(self.axis);
        if depth <= 0.0 {
            return None;
        }
        self.grid.cell(DVec2::new(away.dot(self.right), away.dot(self.up)) / depth)
    }

    /// A direction of the image with its pixel and |cos θ| over its density, sr: uniform over the plane of tangents, in
    /// which dω = cos³θ dA.
    pub(crate) fn draw(&self, u: [f64; 2]) -> Option<(DVec3, usize, f64)> {
        let rect = self.grid.rect();
        let size = rect.max - rect.min;
        let tangents = rect.min + DVec2::from(u) * size;
        let pixel = self.grid.cell(tangents)?;
        let to = self.axis + tangents.x * self.right + tangents.y * self.up;
        let cos4 = 1.0 / (1.0 + tangents.length_squared()).powi(2);
        Some((to.normalize(), pixel, size.element_product() * cos4))
    }

    /// |cos θ| over the density with which [`Pixels::draw`] gives a direction of the image, sr.
    pub(crate) fn projected_toward(&self, dir: DVec3) -> f64 {
        let rect = self.grid.rect();
        (rect.max - rect.min).element_product() * dir.dot(self.axis).powi(4)
    }
}

/// Projected solid angle, in sr, of a rectangle in the plane at distance 1 that the axis meets at the origin: the double
/// difference of F(x, y) over its corners, with ∂²F/∂x∂y = cos⁴θ = 1/(1 + x² + y²)² (configuration factor C-11 of
/// Howell's catalogue, times π).
fn projected_rectangle(rect: ChartRect) -> f64 {
    let corner = |x: f64, y: f64| {
        let (a, b) = (1.0f64.hypot(x), 1.0f64.hypot(y));
        0.5 * (x / a * (y / a).atan() + y / b * (x / b).atan())
    };
    let ChartRect { min, max } = rect;
    corner(max.x, max.y) - corner(min.x, max.y) - corner(max.x, min.y) + corner(min.x, min.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn tilted() -> Frame {
        Frame::from_axis(DVec3::ZERO, DVec3::new(0.3, -0.2, 0.9))
    }

    #[test]
    fn projected_solid_angles_add_up_to_that_of_the_image_and_to_pi_for_nearly_the_half_space() {
        let all = |image: &Pixels| image.projected.iter().sum::<f64>();
        let (fine, coarse) =
            (Pixels::new(&tilted(), [24, 12], 0.02), Pixels::new(&tilted(), [2, 1], 0.0));
        assert_eq!(all(&coarse), 0.0);
        // The same field in one pixel.
        let half = DVec2::new(24.0, 12.0) * 0.01f64.tan();
        let whole = projected_rectangle(ChartRect { min: -half, max: half });
        assert!((all(&fine) / whole - 1.0).abs() < 1e-12);
        let wide = Pixels::new(&tilted(), [40, 40], 0.9995 * PI);
        assert!((all(&wide) / PI - 1.0).abs() < 1e-4, "{}", all(&wide));
    }

    #[test]
    fn a_small_pixel_has_the_solid_angle_of_its_middle() {
        let image = Pixels::new(&tilted(), [301, 1], 0.25f64.to_radians());
        let pitch = 2.0 * 0.125f64.to_radians().tan();
        for column in [0, 75, 150] {
            let tangent = (column as f64 - 150.0) * pitch;
            let expected = pitch * pitch / (1.0 + tangent * tangent).powi(2);
            assert!((image.projected[column] / expected - 1.0).abs() < 1e-5, "{column}");
        }
    }

    #[test]
    fn drawn_directions_lie_in_their_pixels_and_fill_them_as_their_weights_say() {
        let image = Pixels::new(&tilted(), [5, 4], 0.3);
        let n: u32 = 400;
        let mut sums = vec![0.0; image.count()];
        for i in 0..n * n {
            let u = [f64::from(i % n) + 0.5, f64::from(i / n) + 0.5].map(|u| u / f64::from(n));
            let (dir, pixel, weight) = image.draw(u).unwrap();
            assert_eq!(image.pixel(dir), Some(pixel));
            sums[pixel] += weight / f64::from(n * n);
        }
        for (sum, projected) in sums.iter().zip(&image.projected) {
            assert!((sum / projected - 1.0).abs() < 1e-4, "{sum}, not {projected}");
        }
    }

    #[test]
    fn the_image_is_as_the_eye_sees_it() {
        let image = Pixels::new(&Frame::WORLD, [2, 2], 0.1);
        let seen = |x: f64, y: f64| image.pixel(DVec3::new(x, y, 1.0).normalize());
        // Looking along +z with +y up, +x is on the left. Pixels count from the left and from
        // below.
        assert_eq!(seen(0.05, -0.05), Some(0));
        assert_eq!(seen(-0.05, -0.05), Some(1));
        assert_eq!(seen(0.05, 0.05), Some(2));
        assert_eq!(seen(0.2, 0.0), None);
        assert_eq!(image.pixel(DVec3::new(0.0, 0.01, -1.0).normalize()), None);
    }
}
