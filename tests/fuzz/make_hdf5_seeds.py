"""The HDF5 files of the corpus: small, values without checksums, so that a changed byte gets through to the reader; a whole
one of each kind, and ones whose datasets have extents, types and values that nobody writes by intent. Files of the oldest
format have no checksums in their headers either; they are walked through in a process of their own first, which is slow.

Usage: make_hdf5_seeds.py CORPUS
"""

import pathlib
import sys

import h5py
import numpy

corpus = pathlib.Path(sys.argv[1])
TEXT = numpy.dtype("S12")
nodes = numpy.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], float)
n, m = 6, 2


def put(file, name, values):
    """Values in the header itself, so that the file stays small."""
    values = numpy.asarray(values)
    layout = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    layout.set_layout(h5py.h5d.COMPACT)
    links = h5py.h5p.create(h5py.h5p.LINK_CREATE)
    links.set_create_intermediate_group(True)
    space = h5py.h5s.create_simple(values.shape) if values.shape else h5py.h5s.create(h5py.h5s.SCALAR)
    dataset = h5py.h5d.create(file.id, name.encode(), h5py.h5t.py_create(values.dtype), space, layout, links)
    if values.size:
        dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, values)


def format_of(file, name, **numbers):
    file["tailrun"].attrs["format"] = numpy.bytes_(name)
    for key, value in numbers.items():
        file["tailrun"].attrs[key] = value


def snapshot(changes):
    point, cell = "VTKHDF/PointData/", "VTKHDF/CellData/"
    data = {"VTKHDF/Points": nodes, "VTKHDF/Connectivity": [0, 1, 4, 3, 1, 2, 5, 4], cell + "region_id": numpy.int32([0, 0]),
            "tailrun/base_velocity": [0.0, 0.0], "tailrun/region_names": numpy.array([b"tailings"], TEXT),
            "tailrun/phreatic_line": [[0.0, 0.8], [2.0, 0.8]], "tailrun/lines/base": [[0, 1], [1, 2]],
            "tailrun/lines/top": [[3, 4], [4, 5]], "tailrun/ponds/level": [1.5],
            "tailrun/ponds/lines": numpy.array([b"top"], TEXT)}
    data |= {point + name: numpy.zeros((n, 3)) for name in ("displacement", "velocity", "acceleration")}
    data |= {point + name: numpy.full(n, 5e3) for name in ("pore_pressure", "excess_pore_pressure")}
    data |= {cell + name: numpy.full(m, 1.0) for name in
             ("thickness", "porosity", "initial_vertical_effective_stress", "initial_pore_pressure", "depth",
              "excess_pore_pressure_ratio", "max_excess_pore_pressure_ratio", "effective_stress_ratio", "shear_strain",
              "scaled_jacobian")}
    data |= {cell + name: numpy.full((m, 4), -1e4) for name in
             ("effective_stress", "total_stress", "initial_effective_stress")}
    data[cell + "density"] = numpy.full(m, 1900.0)
    return data | changes, ("tailrun-snapshot", dict(format_version=1, time_s=3.0, gravity_m_s2=9.81, fluid_density_kg_m3=1e3))


def particles(changes):
    point = "VTKHDF/PointData/"
    data = {"VTKHDF/Points": nodes, point + "velocity": numpy.zeros((n, 3)), point + "mass": numpy.full(n, 475.0),
            point + "volume": numpy.full(n, 0.25), point + "effective_stress": numpy.full((n, 4), -1e4),
            point + "pore_pressure": numpy.zeros(n), point + "residual_strength": numpy.full(n, 2e3),
            point + "material_id": numpy.zeros(n, "i4"), point + "region_id": numpy.zeros(n, "i4"),
            point + "strength_law": numpy.zeros(n, "i4"), point + "temperature": numpy.full(n, 8.0),
            "tailrun/material_names": numpy.array([b"tailings"], TEXT), "tailrun/region_names": numpy.array([b"beach"], TEXT),
            "tailrun/strength_laws": numpy.array([b"{}"], TEXT), "tailrun/terrain/bed": [[-5.0, 0.0], [9.0, 0.0]],
            "tailrun/ponds/name": numpy.array([b"lake"], TEXT), "tailrun/ponds/level": [1.0], "tailrun/ponds/extent": [[0.0, 1.0]],
            "tailrun/ponds/endless": numpy.int32([[0, 0]]), "tailrun/ponds/density": [1e3],
            "tailrun/notes/author": numpy.array([b"nobody"], TEXT)}
    return data | changes, ("tailrun-particles", dict(format_version=1, dimension=2.0, time_s=3.0, transfer_time_s=3.0,
                                                      particle_size_m=0.5))


def write(kind, name, changes=None, format="earliest"):
    folder = corpus / f"{kind.__name__}_file"
    folder.mkdir(parents=True, exist_ok=True)
    data, (form, numbers) = kind(changes or {})
    with h5py.File(folder / f"{name}.h5", "w", libver=(format, format) if format != "earliest" else format) as file:
        for key, values in data.items():
            put(file, key, values)
        format_of(file, form, **numbers)


empty2 = numpy.zeros((2, 0))
write(snapshot, "whole")
write(snapshot, "base_velocity_without_columns", {"tailrun/base_velocity": empty2})
write(snapshot, "base_velocity_in_two_columns", {"tailrun/base_velocity": numpy.zeros((2, 2))})
write(snapshot, "line_without_columns", {"tailrun/lines/base": numpy.zeros((2, 0), "i8")})
write(snapshot, "phreatic_line_without_columns", {"tailrun/phreatic_line": empty2})
write(snapshot, "scalar_region", {"VTKHDF/CellData/region_id": numpy.int32(0)})
write(snapshot, "pond_of_no_line", {"tailrun/ponds/lines": numpy.array([b"|topp||"], TEXT)})
write(snapshot, "node_out_of_range", {"VTKHDF/Connectivity": numpy.uint64([0, 1, 4, 3, 1, 2, 2**64 - 1, 4])})
write(snapshot, "whole_of_1.10", format="v110")
write(particles, "whole")
write(particles, "whole_of_1.10", format="v110")
write(particles, "terrain_without_columns", {"tailrun/terrain/bed": empty2})
write(particles, "pond_without_columns", {"tailrun/ponds/extent": numpy.zeros((1, 0))})
write(particles, "no_particles", {"VTKHDF/Points": numpy.zeros((0, 3))})
write(particles, "material_beyond_32_bits", {"VTKHDF/PointData/material_id": numpy.full(n, 2**40)})
write(particles, "texts_without_length", {"tailrun/material_names": numpy.zeros(0, TEXT)})
write(particles, "stress_in_one_column", {"VTKHDF/PointData/effective_stress": numpy.zeros(n)})
