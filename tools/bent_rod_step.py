#!/usr/bin/env python3
"""Writes the rod with a bend of benchmark B3 as a STEP file: the example of docs/cad.md.

    pip install cadquery-ocp-novtk==8.0.1.1.0
    python3 tools/bent_rod_step.py bent_rod.step

Radius 1.5 mm; 10 mm straight along z, a quarter turn of radius 8 mm toward x, 10 mm straight.
"""

import sys

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipe
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

RADIUS, LEG, BEND = 1.5, 10.0, 8.0


def main():
    start, bend = gp_Pnt(0, 0, 0), gp_Pnt(0, 0, LEG)
    turned, end = gp_Pnt(BEND, 0, LEG + BEND), gp_Pnt(BEND + LEG, 0, LEG + BEND)
    half = BEND * 0.5**0.5
    arc = GC_MakeArcOfCircle(bend, gp_Pnt(BEND - half, 0, LEG + half), turned).Value()
    edges = [BRepBuilderAPI_MakeEdge(start, bend), BRepBuilderAPI_MakeEdge(arc), BRepBuilderAPI_MakeEdge(turned, end)]
    spine = BRepBuilderAPI_MakeWire(*(edge.Edge() for edge in edges)).Wire()
    circle = gp_Circ(gp_Ax2(start, gp_Dir(0, 0, 1)), RADIUS)
    profile = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()).Face()
    writer = STEPControl_Writer()
    writer.Transfer(BRepOffsetAPI_MakePipe(spine, profile).Shape(), STEPControl_AsIs)
    writer.Write(sys.argv[1] if len(sys.argv) > 1 else "bent_rod.step")


if __name__ == "__main__":
    main()
