"""A case that begins with import.json: make goes from its tables to the pictures and the report, makes again what a changed table
touches, and refuses what such a case cannot mean.

Usage: import_test.py BIN_FOLDER SOURCE_FOLDER
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

programs, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
GRAVITY, DENSITY, HEIGHT, WIDTH = 9.81, 1900.0, 3, 6


def rows(path, names, lines):
    path.write_text("\n".join([names, *(",".join(str(word) for word in line) for line in lines)]) + "\n")


def make_case(folder):
    """A column of water-logged soil between walls, at rest before the shaking, half of its weight on the water after."""
    folder.mkdir(parents=True)
    node = lambda i, j: 1 + i + (WIDTH + 1) * j  # noqa: E731
    nodes = [(node(i, j), i, j) for j in range(HEIGHT + 1) for i in range(WIDTH + 1)]
    quads = [(1 + i + WIDTH * j, i, j) for j in range(HEIGHT) for i in range(WIDTH)]
    rows(folder / "nodes.csv", "node,x,y", nodes)
    rows(folder / "quads.csv", "element,n1,n2,n3,n4,region",
         [(e, node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1), "tailings") for e, i, j in quads])
    for suffix, share in (("0", 0.0), ("1", 0.5)):
        weight = [(DENSITY - 1000.0) * GRAVITY * (HEIGHT - j - 0.5) for _, _, j in quads]
        rows(folder / f"e{suffix}.csv", "element,sxx,syy,sxy",
             [(e, *([s * (1.0 - share)] * 2), 0.0) for (e, _, _), s in zip(quads, weight)])
        rows(folder / f"n{suffix}.csv", "node,p",
             [(n, (1000.0 + share * (DENSITY - 1000.0)) * GRAVITY * (HEIGHT - y)) for n, _, y in nodes])
    (folder / "import.json").write_text(json.dumps({
        "time": 10.0, "nodes": "nodes.csv", "quads": "quads.csv", "node_state": "n1.csv", "element_state": "e1.csv",
        "initial_node_state": "n0.csv", "initial_element_state": "e0.csv", "phreatic_line": [[0, HEIGHT], [WIDTH, HEIGHT]],
        "regions": {"tailings": {"density": DENSITY, "porosity": 0.45}}}))
    (folder / "transfer.json").write_text(json.dumps({
        "rules": [{"material": "liquefied", "when": {"excess_pore_pressure_ratio": {"above": 0.4}},
                   "residual_strength": {"model": "constant", "strength": 2000.0}}]}))
    (folder / "mpm.json").write_text(json.dumps({
        "grid": {"cell_size": 1.0}, "time": {"end": 0.5},
        "materials": {"liquefied": {"model": "tresca", "youngs_modulus": 5e6, "poisson_ratio": 0.49, "cohesion": "from_particles"}},
        "terrain": [{"points": [[-50, 0], [50, 0]], "friction": 0.5}],
        "domain": {"low": [0, -1], "high": [40, 10], "walls": {"left": {"kind": "slip"}}},
        "output": {"frame_interval": 0.1, "series_interval": 0.05}}))


with tempfile.TemporaryDirectory() as name:
    root = pathlib.Path(name)
    (root / "cases").mkdir()
    shutil.copy(source / "Makefile.cases", root)
    shutil.copy(source / "cases" / "case_part.py", root / "cases")
    for folder in ("run", "plot"):
        shutil.copytree(source / "cases" / folder, root / "cases" / folder, ignore=shutil.ignore_patterns("__pycache__"))
    case, out = root / "cases" / "given", root / "out" / "given"
    make_case(case)
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}
    environment["OMP_NUM_THREADS"] = "1"

    def make(*words):
        command = ["make", "-f", "Makefile.cases", "pipeline", "CASE=given", f"BIN={programs}", "FILM=0", f"PYTHON={sys.executable}", *words]
        return subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)

    def stages(result):
        return [word for word in ("transfer_tool import", "transfer_tool run", "mpm_stage run", "fem_figures.py", "report.py") if word in result.stdout]

    first = make()
    assert first.returncode == 0, first.stdout[-3000:] + first.stderr[-3000:]
    for path in ("fem/snapshot.h5", "particles.h5", "mpm/summary.json", "figures/excess_pore_pressure_ratio.png", "figures/mesh.png",
                 "figures/displacement_fem.png", "figures/handover.png", "figures/runout.png", "figures/overview.png", "figures/report.html"):
        assert (out / path).stat().st_size > 0, path
    report = (out / "figures" / "report.html").read_text()
    assert "The imported state (import.json)" in report and "excess_pore_pressure_ratio.png" in report and "strength, liquefied" in report
    assert json.loads((out / "mpm" / "summary.json").read_text())["stop_reason"] == "end time"
    assert stages(make()) == []

    time.sleep(0.02)
    os.utime(case / "e1.csv")
    assert len(stages(make())) == 5

    at_another_time = make("T=5")
    assert at_another_time.returncode != 0 and "state of one time" in at_another_time.stderr, at_another_time.stderr
    (case / "fem.json").write_text("{}")
    both = make()
    assert both.returncode != 0 and "fem.json and import.json" in both.stderr, both.stderr
    (case / "fem.json").unlink()
    (case / "e1.csv").write_text((case / "e1.csv").read_text().replace("sxx,", "sxx_furlong,"))
    wrong = make()
    assert wrong.returncode != 0 and "furlong" in wrong.stdout + wrong.stderr, wrong.stdout[-500:]
    assert (out / "figures" / "report.html").exists() and (out / "fem" / "snapshot.h5").exists()
