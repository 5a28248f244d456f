"""A snapshot and a particles file open in VTK's own reader as ParaView uses it: counts, fields and bounds are right.

Usage: vtkhdf_opens_test.py TRANSFER_TOOL FOLDER, where FOLDER holds import.json and transfer.json of a 4 x 10 m column.
Exit status 77 where python3-vtk9 is not installed.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    print("python3-vtk9 is not installed")
    sys.exit(77)

tool, folder = sys.argv[1], pathlib.Path(sys.argv[2])


def opened(path):
    reader = vtk.vtkHDFReader()
    assert reader.CanReadFile(str(path)), f"VTK refuses {path}"
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetClassName() == "vtkUnstructuredGrid", grid.GetClassName()
    return grid


def arrays(data):
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def same(found, expected, what, tolerance=1e-9):
    assert math.isclose(found, expected, rel_tol=tolerance, abs_tol=tolerance), f"{what}: {found}, not {expected}"


def check_snapshot(path):
    grid = opened(path)
    assert (grid.GetNumberOfPoints(), grid.GetNumberOfCells()) == (55, 40)
    assert all(grid.GetCellType(i) == vtk.VTK_QUAD for i in range(40))
    for found, expected in zip(grid.GetBounds(), (0, 4, 0, 10, 0, 0)):
        same(found, expected, "bounds of the snapshot")
    points, cells = arrays(grid.GetPointData()), arrays(grid.GetCellData())
    for name, columns in {"displacement": 3, "velocity": 3, "pore_pressure": 1}.items():
        assert points[name].size == 55 * columns, name
    for name, columns in {"effective_stress": 4, "total_stress": 4, "excess_pore_pressure_ratio": 1, "depth": 1,
                          "initial_vertical_effective_stress": 1, "region_id": 1}.items():
        assert cells[name].size == 40 * columns, name
    same(points["pore_pressure"].max(), 1000 * 9.81 * 10, "pore pressure at the base", 1e-5)
    same(cells["effective_stress"][:, 1].min(), -900 * 9.81 * 9.5, "vertical effective stress at the base", 1e-5)


def check_particles(path):
    grid = opened(path)
    report = json.loads(subprocess.run([tool, "info", "--json", path], check=True, capture_output=True).stdout)
    assert grid.GetNumberOfPoints() == grid.GetNumberOfCells() == report["points"] == 640
    assert all(grid.GetCellType(i) == vtk.VTK_VERTEX for i in range(640))
    for found, expected in zip(grid.GetBounds(), (0.125, 3.875, 0.125, 9.875, 0, 0)):
        same(found, expected, "bounds of the particles")
    points = arrays(grid.GetPointData())
    same(points["mass"].sum(), 4 * 10 * 1900, "mass")
    same(points["volume"].sum(), 40, "volume")
    for field in report["fields"]:
        name = field["name"].rsplit("/", 1)[1]
        columns = points[name].reshape(640, -1)
        assert list(columns.shape) == (field["shape"] + [1])[:2], name
        for k, expected in enumerate(field["max"]):
            same(float(columns[:, k].max()), expected, name)
    for name, columns in {"velocity": 3, "displacement": 3, "effective_stress": 4, "pore_pressure": 1, "material_id": 1,
                          "residual_strength": 1}.items():
        assert points[name].size == 640 * columns, name


with tempfile.TemporaryDirectory() as name:
    snapshot, particles = pathlib.Path(name, "snapshot.h5"), pathlib.Path(name, "particles.h5")
    subprocess.run([tool, "import", "-q", folder / "import.json", "-o", snapshot], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([tool, "run", "-q", folder / "transfer.json", "--snapshot", snapshot, "-o", particles], check=True, stdout=subprocess.DEVNULL)
    check_snapshot(snapshot)
    check_particles(particles)
print("VTK", vtk.vtkVersion().GetVTKVersion(), "opens both formats")
