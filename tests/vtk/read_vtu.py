#!/usr/bin/env python3
"""read_vtu.py plain|meshio|pyvista: content of each .vtu file that a line of standard input names, as a line of JSON:
{points, cells, point_data, cell_data, field_data}. A cell is [VTK's number of its type, points]. `plain` needs only Python, and is strict.
"""
import base64
import json
import pathlib
import struct
import sys
import xml.etree.ElementTree

LETTERS = {"Int32": "i", "UInt8": "B", "Float64": "d"}
COMPONENTS = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]


def plain_array(element, rows, order):
    """The values of a DataArray: numbers, or lists of its components."""
    assert element.get("format") == "binary", element.attrib
    data = base64.b64decode(element.text.strip(), validate=True)
    letter, components = LETTERS[element.get("type")], int(element.get("NumberOfComponents", 1))
    count = len(data[8:]) // struct.calcsize(letter)
    assert struct.unpack(order + "Q", data[:8]) == (len(data) - 8,), element.attrib
    assert rows is None or count == rows * components, element.attrib
    if components == 6:
        assert [element.get(f"ComponentName{c}") for c in range(6)] == COMPONENTS, element.attrib
    values = list(struct.unpack(f"{order}{count}{letter}", data[8:]))
    return values if components == 1 else [values[i:i + components] for i in range(0, count, components)]


def plain(path):
    root = xml.etree.ElementTree.parse(path).getroot()
    assert (root.tag, root.get("type"), root.get("version"), root.get("header_type")) == ("VTKFile", "UnstructuredGrid", "1.0", "UInt64")
    order = {"LittleEndian": "<", "BigEndian": ">"}[root.get("byte_order")]
    piece = root.find("UnstructuredGrid/Piece")
    points, cells = int(piece.get("NumberOfPoints")), int(piece.get("NumberOfCells"))

    def arrays(parent, rows):
        return {element.get("Name"): plain_array(element, rows, order) for element in parent}

    last = arrays(piece.find("Cells"), None)
    assert len(last["offsets"]) == len(last["types"]) == cells and last["offsets"][-1:] == [len(last["connectivity"])][:cells]
    first = [0, *last["offsets"]]
    return {"points": arrays(piece.find("Points"), points)["Points"],
            "cells": [[kind, last["connectivity"][a:b]] for kind, a, b in zip(last["types"], first, last["offsets"])],
            "point_data": arrays(piece.find("PointData"), points), "cell_data": arrays(piece.find("CellData"), cells),
            "field_data": arrays(root.find("UnstructuredGrid/FieldData"), 1)}


def by_meshio(path):
    import meshio

    number = {"vertex": 1, "line": 3, "triangle": 5, "quad": 9, "triangle6": 22}
    mesh = meshio.read(path)
    return {"points": mesh.points.tolist(),
            "cells": [[number[block.type], nodes] for block in mesh.cells for nodes in block.data.tolist()],
            "point_data": {name: values.tolist() for name, values in mesh.point_data.items()},
            "cell_data": {name: [value for block in blocks for value in block.tolist()] for name, blocks in mesh.cell_data.items()},
            "field_data": {name: values.tolist() for name, values in mesh.field_data.items()}}


def by_pyvista(path):
    import pyvista

    grid = pyvista.read(path)
    kinds, nodes, first = grid.celltypes.tolist(), grid.cell_connectivity.tolist(), grid.cell_offsets.tolist()
    return {"points": grid.points.tolist(), "cells": [[kind, nodes[a:b]] for kind, a, b in zip(kinds, first, first[1:])],
            **{part: {name: getattr(grid, part)[name].tolist() for name in getattr(grid, part).keys()}
               for part in ("point_data", "cell_data", "field_data")}}


if __name__ == "__main__":
    reader = {"plain": plain, "meshio": by_meshio, "pyvista": by_pyvista}[sys.argv[1]]
    for line in sys.stdin:
        print(json.dumps(reader(pathlib.Path(line.rstrip("\n"))), allow_nan=False), flush=True)
