"""Arrays of the committed reports as numpy reads them, against the tables beside them: every number must be the same.

Usage: arrays.py, from the folder of the repository.
"""

import csv
from pathlib import Path

import numpy as np

# First columns of the tables of maps and intensities.
PLACES = (["u_mm", "v_mm"], ["u_deg", "v_deg"], ["sector_deg", "radius_mm"])
ANGLES = ["c_from_deg", "c_to_deg", "gamma_from_deg", "gamma_to_deg"]


def plain(unit):
    return unit.replace("/", "_per_").replace("²", "2")


def same(array, numbers, what):
    assert np.array_equal(array, np.array(numbers, float), equal_nan=True), f"{what} differs"


def compare(path, arrays, quantity):
    """Compares a table with its arrays; the number of values, or 0 for tables of other kinds."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    is_map = header[:2] in PLACES
    if not is_map and header[:4] != ANGLES:
        return 0
    first = 2 if is_map else 4
    columns = {name: [float(row[place]) for row in rows] for place, name in enumerate(header)}
    unit = header[first + 1].removeprefix("std_error_")
    values = arrays[f"{quantity}_{plain(unit)}"]
    # Tables leave out what lies outside of a sensor.
    lit = np.isfinite(values)
    same(values[lit], columns[header[first]], path)
    same(arrays[f"{quantity}.std_error_{plain(unit)}"][lit], columns[header[first + 1]], path)
    if "on_sensor" in columns:
        same(arrays["on_sensor"][lit], columns["on_sensor"], path)
    if f"bias_{unit}" in columns:
        same(arrays[f"{quantity}.bias_{plain(unit)}"][lit], columns[f"bias_{unit}"], path)
    for name in ("colour_u", "colour_v"):
        if name in columns:
            same(arrays[f"{quantity}.{name}"][lit], columns[name], path)
            same(arrays[f"{quantity}.{name}.std_error"][lit], columns[f"{name}_std_error"], path)
    row, column = np.nonzero(lit)
    x, y = (arrays[name] for name in arrays.files if "_edges_" in name)
    ends = [(x[column], x[column + 1]), (y[row], y[row + 1])]
    if is_map:
        for name, (low, high) in zip(header[:2], ends):
            same(0.5 * (low + high), columns[name], path)
    else:
        for name, edge in zip(ANGLES, (ends[0] + ends[1])):
            same(edge, columns[name], path)
    return len(rows)


def main():
    files = values = 0
    for path in sorted(Path("reports").rglob("*.npz")):
        arrays = np.load(path)
        for table in sorted(path.parent.glob(f"{path.stem}.*.csv")):
            quantity = table.name.removeprefix(f"{path.stem}.").removesuffix(".csv")
            if not quantity.endswith(".matrix"):
                values += compare(table, arrays, quantity)
        files += 1
    assert files > 20 and values > 10_000, "there are too few arrays"
    print(f"{values} values in {files} files of arrays are those of the tables")


main()
