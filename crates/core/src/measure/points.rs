//! The points at which display practice reads a field.
//!
//! Nine points are the middles of 3 x 3 equal fields (ANSI/NAPM IT7.228-1997, IEC 61947-1:2002; the same nine in
//! ISO 11315-1 for projected light). Thirteen add four near the corners, here 10 % of the width and of the height
//! from the edges, as VESA FPDM 2 and the IDMS place the outer points of a display; IT7.228 puts them at 10 % of the
//! way from the corner to the centre, which is 5 % of the width and the height. A point reads the cell it lies in;
//! on a line between cells, all cells that touch it, by area.

use crate::scene::Grid;
use glam::DVec2;
use std::f64::consts::TAU;

/// Middles of three equal fields, as fractions of the width.
const FIELDS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
/// Corner points, as fractions of the width.
const CORNERS: [f64; 2] = [0.1, 0.9];
/// A point nearer than this to a line between cells, in cells, lies on it.
const ON_LINE: f64 = 1e-9;
/// With fewer columns or rows than this, neighbouring points would read the same cells.
const MIN_CELLS: usize = 3;

/// The nine points over the grid's rectangle, each as the cells it reads; `None` with too few cells.
pub(crate) fn nine(grid: &Grid) -> Option<Vec<Vec<usize>>> {
    match grid {
        Grid::Cartesian { nu, nv, .. } if *nu.min(nv) < MIN_CELLS => None,
        Grid::Polar { rings, .. } if *rings < MIN_CELLS => None,
        Grid::Cartesian { .. } | Grid::Polar { .. } => at_all(grid, &FIELDS),
    }
}

/// The nine points and four near the corners.
pub(crate) fn thirteen(grid: &Grid) -> Option<Vec<Vec<usize>>> {
    let mut points = nine(grid)?;
    points.extend(at_all(grid, &CORNERS)?);
    Some(points)
}

/// The cells at the middle of the grid's rectangle.
pub(crate) fn center(grid: &Grid) -> Vec<usize> {
    cells_at(grid, DVec2::splat(0.5))
}

/// The cells at all pairs of positions; `None` if one of them is outside.
fn at_all(grid: &Grid, places: &[f64]) -> Option<Vec<Vec<usize>>> {
    let pairs = places.iter().flat_map(|&y| places.iter().map(move |&x| DVec2::new(x, y)));
    let points: Vec<_> = pairs.map(|place| cells_at(grid, place)).collect();
    points.iter().all(|cells| !cells.is_empty()).then_some(points)
}

/// The cells that touch a position, given as fractions of width and height; none outside the grid.
fn cells_at(grid: &Grid, place: DVec2) -> Vec<usize> {
    match grid {
        Grid::Cartesian { nu, nv, .. } => {
            let columns = bins_at(place.x * *nu as f64, *nu);
            let rows = bins_at(place.y * *nv as f64, *nv);
            rows.iter()
                .flat_map(|row| columns.iter().map(move |column| row * nu + column))
                .collect()
        }
        Grid::Polar { rings, sectors, .. } => {
            let from_center = 2.0 * place - DVec2::ONE;
            let radius = from_center.length() * *rings as f64;
            if radius < ON_LINE {
                return (0..*sectors).collect();
            }
            let turn = from_center.y.atan2(from_center.x).rem_euclid(TAU) / TAU;
            let mut around = bins_at(turn * *sectors as f64, *sectors);
            // The first and the last sector meet at +u.
            if (turn * *sectors as f64) < ON_LINE && *sectors > 1 {
                around.push(sectors - 1);
            }
            let rings = bins_at(radius, *rings);
            rings.iter().flat_map(|ring| around.iter().map(move |at| ring * sectors + at)).collect()
        }
    }
}

/// The bins of unit width that touch a position.
fn bins_at(place: f64, bins: usize) -> Vec<usize> {
    let low = (place - ON_LINE).floor().max(0.0) as usize;
    let high = (place + ON_LINE).floor().max(0.0) as usize;
    (low..=high).filter(|&bin| bin < bins).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::ChartRect;

    fn cartesian(nu: usize, nv: usize) -> Grid {
        Grid::Cartesian { rect: ChartRect { min: DVec2::ZERO, max: DVec2::ONE }, nu, nv }
    }

    #[test]
    fn nine_points_are_the_middles_of_nine_fields() {
        let single = |cell: usize| vec![cell];
        assert_eq!(nine(&cartesian(3, 3)).unwrap(), (0..9).map(single).collect::<Vec<_>>());
        assert_eq!(
            nine(&cartesian(5, 5)).unwrap(),
            [0, 2, 4, 10, 12, 14, 20, 22, 24].map(single).to_vec()
        );
        assert_eq!(nine(&cartesian(2, 9)), None);
    }

    #[test]
    fn a_point_on_a_line_reads_all_cells_there() {
        let points = nine(&cartesian(6, 6)).unwrap();
        assert_eq!(points[0], [0, 1, 6, 7]);
        assert_eq!(center(&cartesian(6, 6)), [14, 15, 20, 21]);
        assert_eq!(center(&cartesian(4, 3)), [5, 6]);
    }

    #[test]
    fn thirteen_points_end_near_the_corners_and_not_on_a_disk() {
        let points = thirteen(&cartesian(20, 10)).unwrap();
        assert_eq!(points.len(), 13);
        // 10 % of 20 columns is the line after the second; of 10 rows, after the first.
        assert_eq!(points[9], [1, 2, 21, 22]);
        // 0.8 √2 of the radius is outside.
        let disk = Grid::Polar { radius: 1.0, rings: 10, sectors: 8 };
        assert_eq!(nine(&disk).unwrap().len(), 9);
        assert_eq!(thirteen(&disk), None);
    }

    #[test]
    fn the_middle_of_a_disk_is_all_of_its_first_ring() {
        let disk = Grid::Polar { radius: 1.0, rings: 4, sectors: 3 };
        assert_eq!(center(&disk), [0, 1, 2]);
        // To the right of the middle the first and the last sector meet.
        assert_eq!(cells_at(&disk, DVec2::new(0.8, 0.5)), [6, 8]);
    }
}
