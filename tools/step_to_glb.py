#!/usr/bin/env python3
"""Turns the solids of a STEP file into meshes that Lumiduct reads: one GLB a solid, in metres as glTF wants it.

    pip install cadquery-ocp-novtk==8.0.1.1.0 numpy
    python3 tools/step_to_glb.py guide.step -o meshes --angle 6 --face entry=1

Triangles share the nodes of the edges between faces, so that a closed solid becomes a closed mesh, and every corner has
the normal of the exact surface there: docs/cad.md has what that is worth. Faces keep the names that the STEP file gives
them; all others are called `face_N`, and `--face entry=3` names them. The table that is printed has what there is to know
about each: its kind, area and middle.
"""

import argparse
import json
import math
import struct
import sys
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepGProp import BRepGProp
from OCP.BRepLProp import BRepLProp_SLProps
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

# Metres in a millimetre: STEP files are read in millimetres, glTF is in metres.
METRE = 1e-3


def solids(path):
    """The reader of a STEP file, and the solids in it."""
    Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        sys.exit(f"{path}: no STEP file that can be read")
    reader.TransferRoots()
    shape = reader.OneShape()
    found = list(explore(shape, TopAbs_SOLID, TopoDS.Solid))
    if not found:
        sys.exit(f"{path}: no solid in it; surfaces must be sewn to solids before they are exported")
    return reader, found


def explore(shape, kind, cast):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield cast(explorer.Current())
        explorer.Next()


def step_name(reader, face):
    """The name that the STEP file gives a face, if any."""
    transfer = reader.WS().TransferReader()
    entity = transfer.EntityFromShapeResult(face, 1)
    name = getattr(entity, "Name", lambda: None)() if entity is not None else None
    text = name.ToCString().strip() if name is not None else ""
    return text if text and text.upper() != "NONE" else None


def triangulated(face):
    """Points, normals and triangles of a face, as seen from outside the solid; millimetres."""
    location = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, location)
    if mesh is None:
        sys.exit("a face could not be meshed; try a larger --chord or --angle")
    place = location.Transformation()
    points = [mesh.Node(i + 1).Transformed(place) for i in range(mesh.NbNodes())]
    points = np.array([[p.X(), p.Y(), p.Z()] for p in points])
    flip = face.Orientation() == TopAbs_REVERSED
    triangles = np.array([mesh.Triangle(i + 1).Get() for i in range(mesh.NbTriangles())]) - 1
    if flip:
        triangles = triangles[:, [0, 2, 1]]
    surface = BRepAdaptor_Surface(face)
    normals = np.zeros_like(points)
    for i in range(mesh.NbNodes()):
        uv = mesh.UVNode(i + 1)
        props = BRepLProp_SLProps(surface, uv.X(), uv.Y(), 1, 1e-9)
        if props.IsNormalDefined():
            n = props.Normal()
            normals[i] = (n.X(), n.Y(), n.Z())
    if flip:
        normals = -normals
    # Poles of a surface have none of their own: there the facets' mean counts.
    facets = np.cross(points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]])
    for i in np.flatnonzero(np.linalg.norm(normals, axis=1) == 0):
        normals[i] = facets[np.any(triangles == i, axis=1)].sum(axis=0)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return points, normals, triangles


def write_glb(path, parts):
    """Writes named parts of (points in mm, normals, triangles) as one mesh with a material a part."""
    blob, views, accessors, primitives = bytearray(), [], [], []

    def add(array, kind, target, component):
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": array.nbytes, "target": target})
        accessor = {"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind}
        if kind == "VEC3":
            accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        accessors.append(accessor)
        blob.extend(array.tobytes())
        return len(accessors) - 1

    for index, (_, points, normals, triangles) in enumerate(parts):
        attributes = {
            "POSITION": add((points * METRE).astype("<f4"), "VEC3", 34962, 5126),
            "NORMAL": add(normals.astype("<f4"), "VEC3", 34962, 5126),
        }
        indices = add(triangles.astype("<u4").reshape(-1), "SCALAR", 34963, 5125)
        primitives.append({"attributes": attributes, "indices": indices, "material": index})
    document = {
        "asset": {"version": "2.0", "generator": "Lumiduct tools/step_to_glb.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": [{"name": name} for name, *_ in parts],
        "buffers": [{"byteLength": len(blob)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    blob += b"\0" * (-len(blob) % 4)
    total = 12 + 8 + len(text) + 8 + len(blob)
    head = struct.pack("<4sII", b"glTF", 2, total)
    path.write_bytes(
        head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    )


def convert(reader, solid, target, chord, angle, names, first):
    # Relative deflection off, angle in radians, in one thread, so that the same file comes out every time.
    BRepMesh_IncrementalMesh(solid, chord, False, math.radians(angle), False)
    parts = {}
    number = first
    for number, face in enumerate(explore(solid, TopAbs_FACE, TopoDS.Face), first):
        name = names.get(number) or step_name(reader, face) or f"face_{number}"
        points, normals, triangles = triangulated(face)
        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(face, properties)
        middle = properties.CentreOfMass()
        kind = BRepAdaptor_Surface(face).GetType().name.removeprefix("GeomAbs_").lower()
        print(
            f"  {number:4} {name:20} {kind:20} {properties.Mass():12.4f} mm²"
            f"  ({middle.X():.4f}, {middle.Y():.4f}, {middle.Z():.4f})  {len(triangles)} triangles"
        )
        parts.setdefault(name, []).append((points, normals, triangles))
    joined = []
    for name, pieces in parts.items():
        offsets = np.cumsum([0] + [len(points) for points, *_ in pieces])
        joined.append(
            (
                name,
                np.concatenate([points for points, *_ in pieces]),
                np.concatenate([normals for _, normals, _ in pieces]),
                np.concatenate([triangles + at for (*_, triangles), at in zip(pieces, offsets)]),
            )
        )
    write_glb(target, joined)
    print(f"{target}: {sum(len(part[3]) for part in joined)} triangles, {target.stat().st_size} bytes")
    return number + 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="STEP file (AP203, AP214, AP242)")
    parser.add_argument("-o", "--output", type=Path, default=Path("."), help="folder for the meshes")
    parser.add_argument("--chord", type=float, default=1.0, help="largest distance of a facet from its surface, mm")
    parser.add_argument("--angle", type=float, default=6.0, help="largest turn from facet to facet, deg")
    parser.add_argument("--face", action="append", default=[], metavar="NAME=N", help="names a face by its number; with several solids they count on")
    arguments = parser.parse_args()
    names = {}
    for pair in arguments.face:
        name, _, number = pair.partition("=")
        if not name or not number.isdigit():
            parser.error(f"--face {pair}: expected NAME=N")
        names[int(number)] = name
    arguments.output.mkdir(parents=True, exist_ok=True)
    reader, found = solids(arguments.file)
    next_face = 1
    for number, solid in enumerate(found, 1):
        suffix = "" if len(found) == 1 else f"_{number}"
        target = arguments.output / f"{arguments.file.stem}{suffix}.glb"
        next_face = convert(reader, solid, target, arguments.chord, arguments.angle, names, next_face)
    unknown = [f"{name}={number}" for number, name in names.items() if number >= next_face]
    if unknown:
        sys.exit(f"--face {', '.join(unknown)}: there are {next_face - 1} faces")


if __name__ == "__main__":
    main()
