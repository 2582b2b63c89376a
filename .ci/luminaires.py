"""Luminaire files as luxpy (K. A. G. Smet) reads them, against what Lumiduct has measured and converted.

Usage: luminaires.py PROGRAM, from the folder of the repository. luxpy knows no symmetry about C90-C270 in EULUMDAT and no
goniometer types, so neither is among these files.
"""

import copy
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from luxpy.toolboxes import iolidfiles

# Largest difference of intensities between files, of the peak: files have seven digits.
SAME = 1e-6
# Cells of a goniometer against the table that fits them: largest deviation of the flux, and of the sum of squares in standard errors.
SAME_FLUX = 1e-6
MOST_SQUARES = 1.5
# Angles within a cell, for its mean.
POINTS = 12


class Table:
    """Intensities in cd over all planes and angles in degrees, as luxpy completes them."""

    def __init__(self, path):
        lamp = iolidfiles.read_lamp_data(str(path), normalize=None)
        table = lamp["map"]
        assert table["full"], f"{path}: luxpy does not know its symmetry"
        per_lamp = lamp["tflux"] / 1000.0 if str(path).endswith(".ldt") else lamp["ballast_factor"]
        self.planes = np.asarray(table["phis"], float)
        self.angles = np.asarray(table["thetas"], float)
        self.candela = np.asarray(table["values"], float) * lamp["candela_mult"] * per_lamp
        self.is_relative = lamp["lamps_num"] > 0 and lamp["lumens_per_lamp"] > 0

    def at(self, planes, angles):
        """Linear in both angles."""

        def between(axis, at):
            place = np.clip(np.searchsorted(axis, at, "right") - 1, 0, len(axis) - 2)
            return place, (at - axis[place]) / (axis[place + 1] - axis[place])

        (c, u), (g, v) = between(self.planes, planes), between(self.angles, angles)
        below, above = (self.candela[c, g + n] * (1 - u) + self.candela[c + 1, g + n] * u for n in (0, 1))
        return below * (1 - v) + above * v


def expect(holds, words):
    if not holds:
        sys.exit(f"luminaire files: {words}")
    print(words)


def difference(one, other):
    """The largest difference at the angles of the first, of its peak."""
    planes, angles = np.meshgrid(one.planes, one.angles, indexing="ij")
    return np.abs(other.at(planes, angles) - one.candela).max() / one.candela.max()


def compare_with_cells(table, path):
    """The table has the flux of the cells of the goniometer, and their values within their errors."""
    with open(path, encoding="utf-8-sig") as lines:
        rows = [[float(own) for own in row] for row in list(csv.reader(lines))[1:]]
    c0, c1, g0, g1, measured, errors = np.array(rows).T
    parts, weights = np.polynomial.legendre.leggauss(POINTS)
    middle = lambda first, last, x: 0.5 * (first + last) + 0.5 * (last - first) * x
    means, solid = np.zeros_like(measured), np.zeros_like(measured)
    for v, weight in zip(parts, weights):
        angles = middle(g0, g1, v)
        ring = weight * np.sin(np.radians(angles))
        solid += ring
        means += ring * sum(0.5 * w * table.at(middle(c0, c1, u), angles) for u, w in zip(parts, weights))
    means /= solid
    sizes = solid * (g1 - g0) * (c1 - c0)
    flux = (means * sizes).sum() / (measured * sizes).sum()
    expect(abs(flux - 1) < SAME_FLUX, f"{path}: flux of luxpy's table over that of the cells {flux:.9f}")
    lit = errors > 0
    squares = (((means - measured) / np.where(lit, errors, 1))[lit] ** 2).mean()
    expect(squares < MOST_SQUARES, f"{path}: mean square deviation of {lit.sum()} cells {squares:.3f} standard errors")


def main():
    program = Path(sys.argv[1]).resolve()
    report = Path("reports/ies_in_ies_out")
    files = [Table(report / f"far.{ending}") for ending in ("ies", "ldt")]
    worst = max(difference(files[0], files[1]), difference(files[1], files[0]))
    expect(worst < SAME, f"{report}: far.ies and far.ldt differ by {worst:.1e} of the peak")
    for table in files:
        expect(table.is_relative, f"{report}: relative photometry")
        compare_with_cells(table, report / "far.intensity.csv")
    with tempfile.TemporaryDirectory() as folder:
        originals = [*sorted(Path("scenes/luminaires").glob("*.ies")), Path("tests/luminaires/spot.ies")]
        for original in [*originals, report / "far.ldt"]:
            own = Table(original)
            for name, edition in [("as.ies", "2002"), ("new.ies", "2019"), ("as.ldt", None)]:
                path = Path(folder) / f"{original.stem}_{original.suffix[1:]}_{name}"
                more = ["--edition", edition] if edition else []
                subprocess.run([program, "convert", original, path, *more], check=True, capture_output=True)
                worst = difference(own, Table(path))
                expect(worst < SAME, f"{original} to {name}: {worst:.1e} of the peak")
        # These comparisons notice the sixth digit of one value.
        changed = copy.deepcopy(files[0])
        changed.candela[changed.candela == changed.candela.max()] *= 1 + 5 * SAME
        expect(difference(files[0], changed) > SAME, "a changed value is noticed")



main()
