"""No result takes the place of what a case names: refused with 1 before anything is computed, and the input is as it was.

Usage: kept_inputs_test.py FOLDER_OF_PROGRAMS
"""

import json
import pathlib
import subprocess
import sys
import tempfile

programs = pathlib.Path(sys.argv[1]).resolve()
FEM = {
    "mesh": {"rectangle": {"width": 2, "columns": 2, "layers": [{"region": "soil", "height": 2, "rows": 2}]}},
    "materials": {"soil": {"model": "linear_elastic", "density": 2000, "shear_modulus": 1e7, "poisson_ratio": 0.3}},
    "regions": {"soil": {"material": "soil", "permeability": [0, 0]}},
    "boundaries": {"base": {"line": "bottom", "type": "rigid"}, "roller_lines": ["left", "right"]},
    "loads": [{"stage": "shake", "line": "top", "traction": [0, -1e4], "history": {"type": "csv", "file": "history.csv"}}],
    "shake": {"duration": 0.1, "time_step": 0.01},
}
MPM = {
    "grid": {"cell_size": 0.5}, "time": {"end": 0.01},
    "materials": {"soil": {"model": "mohr_coulomb", "density": 2000, "youngs_modulus": 1e7, "poisson_ratio": 0.3, "cohesion": 1000, "friction_angle": 30}},
    "particles": [{"shape": "box", "low": [0, 0], "high": [1, 1], "material": "soil"}],
    "terrain": [{"points": [[-9, 0], [9, 0]], "friction": 0.5}],
}
TARGET = {"material": {"model": "pm4sand", "relative_density": 0.4, "hpo": 1.0, "density": 1900}, "cyclic_strength": {"csr": 0.1, "cycles": 15, "shear_strain": 0.03, "vertical_effective_stress": 1e5}}

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)

    def refused(file, program, *arguments):
        before = (folder / file).read_bytes()
        run = subprocess.run([programs / program, *arguments], cwd=folder, capture_output=True, text=True)
        assert run.returncode == 1 and "place of the input" in run.stderr and file in run.stderr, (arguments, run.returncode, run.stderr)
        assert (folder / file).read_bytes() == before, file

    (folder / "history.csv").write_text("time,factor\n0,0\n1,1\n")
    (folder / "fem.json").write_text(json.dumps(FEM))
    refused("history.csv", "fem_stage", "run", "fem.json", "-o", ".", "-q")
    (folder / "geostatic.json").write_text(json.dumps({**FEM, "loads": []}))
    refused("geostatic.json", "fem_stage", "run", "geostatic.json", "-o", ".", "-q")
    (folder / "calibration.json").write_text(json.dumps(TARGET))
    refused("calibration.json", "fem_stage", "calibrate", "calibration.json", "-o", ".", "-q")
    (folder / "mpm.json").write_text(json.dumps(MPM))
    (folder / "summary.json").write_text(json.dumps(MPM))
    refused("summary.json", "mpm_stage", "run", "summary.json", "-o", ".", "-q")
    assert subprocess.run([programs / "mpm_stage", "run", "mpm.json", "-o", "out", "-q"], cwd=folder).returncode == 0
    frame = sorted((folder / "out" / "frames").glob("*.vtkhdf"))[-1].relative_to(folder)
    MPM.pop("particles")
    MPM["terrain"] = [{"points": [[-9, 0], [9, 0]], "friction": 0.5}]
    (folder / "mpm.json").write_text(json.dumps(MPM))
    refused(str(frame), "mpm_stage", "run", "mpm.json", "--particles", str(frame), "-o", "out", "-q")
    made = {path.relative_to(folder / "out").as_posix() for path in (folder / "out").rglob("*") if path.is_file()}
    known = {"summary.json", "options.txt", "front.csv", "ledger.csv", "bodies.csv", "sections.csv", ".lock"}
    assert {file for file in made if not file.startswith("frames/")} <= known, f"results that main.cpp does not know: {made - known}"
print("inputs are kept")
