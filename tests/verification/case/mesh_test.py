"""The main case's mesh at each size: sizes, no triangle (fem_stage refuses them), quality, regions, and a mesh line along
the phreatic line below the upper dam.

Usage: mesh_test.py FEM_STAGE SOURCE_FOLDER
"""

import json
import pathlib
import subprocess
import sys
import tempfile

stage, case = sys.argv[1], pathlib.Path(sys.argv[2]) / "cases" / "mochikoshi" / "fem.json"


def nodes(path):
    """Coordinates of a gmsh 4.1 ASCII file."""
    lines = path.read_text().split("\n")
    at = lines.index("$Nodes") + 1
    blocks, found = int(lines[at].split()[0]), []
    at += 1
    for _ in range(blocks):
        count = int(lines[at].split()[3])
        found += [tuple(map(float, line.split()[:2])) for line in lines[at + 1 + count : at + 1 + 2 * count]]
        at += 1 + 2 * count
    return found


for size, wanted in (("coarse", 870), ("default", 2900), ("fine", 12000)):
    with tempfile.TemporaryDirectory() as name:
        where = pathlib.Path(name)
        subprocess.run([stage, "mesh", "-q", case, "-o", where, "--size", size], check=True)
        report = json.loads((where / "mesh.json").read_text())
        assert abs(report["elements"] / wanted - 1.0) < 0.1, (size, report["elements"])
        # The downstream slope meets the ground at 18.5 degrees: sin = 0.318 bounds what a mesh can reach.
        assert report["min_scaled_jacobian"] >= 0.3, (size, report)
        regions = report["elements_by_region"]
        assert set(regions) == {"tailings", "embankment", "foundation", "freefield_tailings", "freefield_foundation"}
        assert sum(regions.values()) == report["elements"], (size, regions)
        below_dam = [(x, y) for x, y in nodes(where / "mesh.msh") if -4.9 < x < 34.0]
        on_line = [x for x, y in below_dam if abs(y - (18.43 - 0.303 * x)) < 1e-6]
        columns = {"coarse": 14, "default": 26, "fine": 52}[size]
        assert len(on_line) >= columns - 2, (size, len(on_line))
