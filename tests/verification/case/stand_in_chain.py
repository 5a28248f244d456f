"""A clone with a case `dam` whose programs are scripts: they write what the real ones write, in no time, and note how they were called.

mpm_stage's runout is 10 m / factor at the default size, and changes with the cell's size by 4 m / factor each metre. It refuses a negative factor, fails above `fails_above`, and waits `slow` seconds.
"""

import copy
import json
import os
import pathlib
import shutil
import subprocess
import sys

PROGRAM = """#!{python}
import json, os, pathlib, signal, sys, time
words = sys.argv[1:]
out = pathlib.Path(words[words.index("-o") + 1])
settings = dict(words[k + 1].split("=", 1) for k, word in enumerate(words) if word == "--set")
name = pathlib.Path(sys.argv[0]).name
def note(text):
    with open("{root}/log", "a") as file:
        file.write(text + "\\n")
note(" ".join([name, words[0], *(["--resume"] if "--resume" in words else []), *(f"{{k}}={{v}}" for k, v in settings.items() if "frame" not in k)]))
def put(path, text="{{}}"):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
if name == "transfer_tool":
    put(out, str(settings))
elif words[0] == "mesh":
    put(out / "mesh.msh")
elif words[0] == "geostatic":
    put(out / "geostatic.h5")
elif words[0] == "shake":
    if float(settings.get("/shake/peak_acceleration", 1)) > 50:
        sys.exit("[error] fem_stage: the mesh folds up")
    put(out / "snapshot_t08.000.h5", str(settings))
    put(out / "summary.json", json.dumps({{"largest_displacement_m": float(settings.get("/shake/peak_acceleration", 1))}}))
else:
    factor = float(settings.get("/residual_strength/factor", 1))
    if factor < 0:
        print("[error] mpm_stage: mpm.json: /residual_strength/factor (from --set): -1 found, a number above 0 is allowed", file=sys.stderr)
        sys.exit(1)
    def stop(*_):
        put(out / "checkpoint.h5")
        sys.exit(2)
    signal.signal(signal.SIGTERM, stop)
    if os.path.exists("{root}/slow") and "--resume" not in words:
        time.sleep(float(open("{root}/slow").read()))
    if factor > {fails_above}:
        print("[error] mpm_stage: the computation failed: energy grows at particle 7", file=sys.stderr)
        sys.exit(2)
    (out / "checkpoint.h5").unlink(missing_ok=True)
    put(out / "front.csv", "time_s,flow_front_m,runout_m,flowed_mass_kg\\n0,0,0,0\\n1,%g,%g,1000\\n" % (10 / factor, 10 / factor))
    put(out / "frames" / "runout_00000.vtkhdf", "x" * 100000)
    cell = {{"coarse": 1.0, "default": 0.75, "fine": 0.375}}[words[words.index("--size") + 1]]
    put(out / "summary.json", json.dumps({{"runout_m": (10 + 4 * (cell - 0.75)) / factor, "flowed_volume_m3": 100 / factor, "flowed_mass_kg": 2e5 / factor,
                                           "particles": 1000, "stop_reason": "at rest"}}))
"""


class Clone:
    def __init__(self, root, source, fails_above=100.0):
        self.root, self.source = pathlib.Path(root), pathlib.Path(source)
        (self.root / "cases").mkdir(parents=True)
        shutil.copy(self.source / "Makefile.cases", self.root)
        shutil.copy(self.source / "cases" / "case_part.py", self.root / "cases")
        for folder in ("run", "plot", "what_if"):
            shutil.copytree(self.source / "cases" / folder, self.root / "cases" / folder, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copytree(self.source / "cases" / "template", self.root / "cases" / "dam")
        (self.root / "bin").mkdir()
        # No two have the same bytes, as no two real ones have: what mpm_stage hands on to mpm_stage_all is of that one's key.
        for program in ("fem_stage", "transfer_tool", "mpm_stage", "mpm_stage_all"):
            path = self.root / "bin" / program
            path.write_text(PROGRAM.format(python=sys.executable, root=self.root, fails_above=fails_above) + f"# {program}\n")
            path.chmod(0o755)
        self.case, self.out, self.log = self.root / "cases" / "dam", self.root / "out" / "dam", self.root / "log"
        self.environment = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "MFLAGS"))}

    def command(self, *words):
        return ["make", "-f", "Makefile.cases", "CASE=dam", "BIN=bin", "FILM=0", f"PYTHON={sys.executable}", *words]

    def make(self, *words, status=None, **options):
        """(what make said, what the programs were called with)."""
        self.log.write_text("")
        result = subprocess.run(self.command(*words), cwd=self.root, env=self.environment, capture_output=True, text=True, **options)
        assert status is None or result.returncode == status, (words, result.returncode, result.stdout, result.stderr)
        return result, sorted(line for line in self.log.read_text().split("\n") if line)

    def refusal(self, content, change):
        """Why a design like `content`, after change(content), is not taken; cases/what_if has to be on the path."""
        import design

        content = copy.deepcopy(content)
        change(content)
        path = self.root / "refused.json"
        path.write_text(json.dumps(content))
        try:
            design.read_design(path, self.case)
        except design.DesignError as error:
            return str(error)
        raise AssertionError(f"{content} was taken")

    def sweep_file(self, content, name="sweep"):
        (self.case / f"{name}.json").write_text(json.dumps(content))


FACTORS = {"design": "grid", "parameters": {"factor": {"key": "mpm:/residual_strength/factor", "values": [0.5, 0.75, 1.25, 2.0]}}}
