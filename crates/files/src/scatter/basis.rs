//! Angle bases of matrices: rings of patches, of the Klems systems or as a file defines them.

use crate::scatter::error::Violation;
use lumiduct_base::math::RingPatches;
use roxmltree::Node;

/// Most patches of a basis.
const MOST_PATCHES: usize = 4096;
/// Most rings of a basis: reflection and transmission are added where their patches overlap, and rings of the one times sectors of the
/// other would be millions of overlaps.
const MOST_RINGS: usize = 256;
/// Most sectors of a ring, for the same reason.
const MOST_SECTORS: usize = 1024;

/// Polar angles between rings, deg, and sectors, of the bases that need no definition (J. H. Klems, A new method for predicting
/// the solar heat gain of complex fenestration systems, ASHRAE Transactions 100, 1994; half and quarter as in Radiance).
const KNOWN: [(&str, &[f64], &[usize]); 3] = [
    (
        "LBNL/Klems Full",
        &[0.0, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0],
        &[1, 8, 16, 20, 24, 24, 24, 16, 12],
    ),
    (
        "LBNL/Klems Half",
        &[0.0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90.0],
        &[1, 8, 12, 16, 20, 12, 8],
    ),
    ("LBNL/Klems Quarter", &[0.0, 9.0, 27.0, 45.0, 63.0, 90.0], &[1, 8, 12, 12, 8]),
];

/// The basis of a name: as an `AngleBasis` element of the file defines it, or a known one.
pub(super) fn basis(
    name: &str,
    definitions: &[Node<'_, '_>],
    line: usize,
) -> Result<RingPatches, Violation> {
    let same = |own: &str| own.trim().eq_ignore_ascii_case(name);
    let defined = definitions.iter().find(|node| text(**node, "AngleBasisName").is_some_and(same));
    if let Some(node) = defined {
        return defined_basis(*node);
    }
    let known = KNOWN.iter().find(|(own, ..)| same(own));
    let patches = known.and_then(|(_, angles, sectors)| rings(angles, sectors.to_vec()));
    patches.ok_or_else(|| {
        let names = KNOWN.map(|(own, ..)| own).join(", ");
        Violation::new(
            line,
            format!("the angle basis `{name}` is neither defined in the file nor one of {names}"),
        )
    })
}

fn rings(angles_deg: &[f64], sectors: Vec<usize>) -> Option<RingPatches> {
    let angles: Vec<f64> = angles_deg.iter().map(|angle| angle.to_radians()).collect();
    RingPatches::new(&angles, sectors)
}

fn defined_basis(node: Node<'_, '_>) -> Result<RingPatches, Violation> {
    let (mut angles, mut sectors, mut count) = (vec![0.0], Vec::new(), 0usize);
    for block in node.children().filter(|child| child.has_tag_name("AngleBasisBlock")) {
        // Finding a line takes as long as the file.
        let wrong = |problem: String| Violation::new(line_of(block), problem);
        let bounds = block.children().find(|child| child.has_tag_name("ThetaBounds"));
        let number = |name: &str| {
            let word = bounds.and_then(|bounds| text(bounds, name)).unwrap_or_default();
            let number = word.trim().parse::<f64>();
            number.map_err(|_| {
                wrong(format!("the {name} of its ThetaBounds, `{word}`, is not a number"))
            })
        };
        let (lower, upper) = (number("LowerTheta")?, number("UpperTheta")?);
        let last = angles[angles.len() - 1];
        if (lower - last).abs() > 1e-6 {
            let problem = format!("LowerTheta is {lower}, but the ring before ends at {last} deg");
            return Err(wrong(problem));
        }
        let word = text(block, "nPhis").unwrap_or_default().trim();
        let phis = word.parse::<usize>().ok().filter(|phis| (1..=MOST_SECTORS).contains(phis));
        let phis =
            phis.ok_or_else(|| wrong(format!("nPhis is `{word}`, expected 1 to {MOST_SECTORS}")))?;
        count += phis;
        if count > MOST_PATCHES {
            return Err(wrong(format!("more than {MOST_PATCHES} patches")));
        }
        if sectors.len() == MOST_RINGS {
            return Err(wrong(format!("more than {MOST_RINGS} rings")));
        }
        angles.push(upper);
        sectors.push(phis);
    }
    rings(&angles, sectors).ok_or_else(|| {
        let problem = "the rings of the angle basis do not grow from 0 to 90 deg";
        Violation::new(line_of(node), problem)
    })
}

/// The text of a child element.
pub(super) fn text<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.children().find(|child| child.has_tag_name(name))?.text()
}

/// The line of an element, from 1.
pub(super) fn line_of(node: Node<'_, '_>) -> usize {
    node.document().text_pos_at(node.range().start).row as usize
}
