"""mpm_stage has the solver that dams' runouts take and starts mpm_stage_all for every other; where that is not built it says how
to build it. cases/run/stages.py and Makefile.cases ask the same of a case.

Usage: solvers_test.py BIN_FOLDER SOURCE_FOLDER
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

programs, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(source / "cases" / "run"))
from stages import asks_for_other_solver  # noqa: E402

SCENE = {
    "grid": {"cell_size": 0.5}, "gravity": [0, 0], "time": {"end": 0.002},
    "materials": {"solid": {"model": "linear_elastic", "density": 2000, "youngs_modulus": 1e6, "poisson_ratio": 0.3}},
    "particles": [{"shape": "box", "low": [0, 0], "high": [1, 1], "material": "solid"}],
    "output": {"frame_interval": 0},
}
SPACE = {"dimension": 3, "gravity": [0, 0, 0], "particles": [{"shape": "box", "low": [0, 0, 0], "high": [1, 1, 1], "material": "solid"}]}
ASKED = [
    ({}, None),
    ({"dimension": 2, "scheme": {"shape_function": "quadratic", "transfer": "aflip"}, "damping": {"local": 0.1}}, None),
    ({"scheme": {"transfer_damping": 0.2}}, None),
    (SPACE, "/dimension"),
    *(({"scheme": {"shape_function": name}}, "/scheme/shape_function") for name in ("linear", "cubic", "gimp")),
    *(({"scheme": {"transfer": name}}, "/scheme/transfer") for name in ("apic", "flip", "fmpm")),
]
makefile = (source / "Makefile.cases").read_text()
in_file = re.search(r"^asks_in_file := (.*)$", makefile, re.M).group(1)

with tempfile.TemporaryDirectory() as name:
    place = pathlib.Path(name)
    alone, both = place / "alone" / "bin", place / "both" / "bin"
    for folder, there in ((alone, ["mpm_stage"]), (both, ["mpm_stage", "mpm_stage_all"])):
        folder.mkdir(parents=True)
        for program in there:
            shutil.copy(programs / program, folder)
    case = place / "mpm.json"

    def run(folder, *options):
        return subprocess.run([folder / "mpm_stage", "run", case, "-o", place / "out", *options], capture_output=True, text=True)

    for changes, pointer in ASKED:
        case.write_text(json.dumps(SCENE | changes, indent=1))
        assert asks_for_other_solver(SCENE | changes) == (pointer is not None), changes
        grep = subprocess.run(["grep", "-qE", in_file, case]).returncode == 0
        assert grep or pointer is None, changes  # make may build mpm_stage_all for nothing, but not miss it
        done = run(alone)
        if pointer is None:
            assert done.returncode == 0, (changes, done.stderr)
        else:
            assert done.returncode == 1 and f"{case}: {pointer}: asks for a solver" in done.stderr, (changes, done.stderr)
            assert "make -f Makefile.cases solvers" in done.stderr and f"--build {place / 'alone'} " in done.stderr, done.stderr
            assert not (place / "out").exists(), "an output folder was made"
        done = run(both)
        assert done.returncode == 0, (changes, done.stderr)
        assert json.loads((place / "out" / "summary.json").read_text())["stop_reason"] == "end time"
        shutil.rmtree(place / "out")

    # Settings count as the file does; what is wrong is said by mpm_stage itself.
    case.write_text(json.dumps(SCENE))
    assert run(alone, "--set", "/scheme/transfer=flip").returncode == 1
    assert run(both, "--set", "/scheme/transfer=flip").returncode == 0
    wrong = run(alone, "--set", "/scheme/transfer=flop")
    assert wrong.returncode == 1 and "aflip" in wrong.stderr and "asks for a solver" not in wrong.stderr, wrong.stderr
print(f"{len(ASKED)} kinds of scenes, by mpm_stage alone and with mpm_stage_all beside it")
