"""fem_stage element with any of its two outputs, both or none: all end with 0 and write what they were asked for; one name for both is refused.

Usage: element_output_test.py FEM_STAGE
"""

import json
import pathlib
import subprocess
import sys
import tempfile

program = pathlib.Path(sys.argv[1]).resolve()
TEST = {
    "material": {"model": "pm4sand", "relative_density": 0.4, "hpo": 1.0, "density": 1930},
    "loading": {"type": "monotonic_simple_shear"},
    "stop": {"shear_strain": 0.01},
}

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "test.json").write_text(json.dumps(TEST))

    def element(*arguments):
        return subprocess.run([program, "element", "test.json", "--quiet", *arguments], cwd=folder, capture_output=True, text=True)

    for arguments in ([], ["-o", "curve.csv"], ["--summary", "summary.json"], ["-o", "other.csv", "--summary", "other.json"]):
        run = element(*arguments)
        assert run.returncode == 0, (arguments, run.stderr)
        for file in arguments[1::2]:
            assert (folder / file).stat().st_size > 0, file
    run = element("-o", "one", "--summary", "./one")
    assert run.returncode == 1 and "--summary" in run.stderr, run.stderr
    assert not (folder / "one").exists()
