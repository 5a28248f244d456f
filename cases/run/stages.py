"""The stages of a case: what each reads, what it writes, and the command that computes it.

A stage's *input* is everything that its results depend on: what it reads of its case file (comments and settings of other
stages left out), the files named there, the size, the program, and the inputs of the stages before it. Two stages of equal
input have equal results, wherever they lie; the SHA-256 of the input is its key.
"""

import hashlib
import json
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import settings as what_if

PLOT = Path(__file__).resolve().parents[1] / "plot"


@dataclass(frozen=True)
class Stage:
    name: str
    program: str  # a program of BIN, or a script of cases/plot
    case: str  # fem, import, transfer, mpm: the case file and the prefix of its settings; "" none
    outputs: tuple  # patterns below the folder of results
    marker: str  # the file whose date make looks at
    after: tuple = ()  # stages that it reads, of those that the case has
    keep: tuple = ()  # keys of the case file that it depends on; all when empty
    drop: tuple = ()
    replaced: tuple = ()  # outputs of an earlier run that would stay beside the new ones
    checkpoint: str = ""  # what its program goes on from with --resume after an interruption


STAGES = {
    stage.name: stage
    for stage in (
        Stage("mesh", "fem_stage", "fem", ("fem/mesh.*",), "fem/mesh.msh", keep=("mesh",)),
        Stage("geostatic", "fem_stage", "fem", ("fem/geostatic.*",), "fem/geostatic.h5", ("mesh",),
              drop=("shake", "output", "consolidation", "title")),
        Stage("shake", "fem_stage", "fem", ("fem/snapshot_t*.h5", "fem/*.series", "fem/*.csv", "fem/summary.json", "fem/shake.options.txt"), "fem/.shaken", ("geostatic",),
              drop=("consolidation",), replaced=("fem/snapshot_t*.h5", "fem/*.series"), checkpoint="fem/shake_checkpoint.h5"),
        Stage("import", "transfer_tool", "import", ("fem/snapshot.h5", "fem/snapshot.options.txt"), "fem/snapshot.h5"),
        Stage("transfer", "transfer_tool", "transfer", ("particles.h5", "particles.options.txt"), "particles.h5", ("shake", "import")),
        Stage("mpm", "mpm_stage", "mpm", ("mpm/*.csv", "mpm/summary.json", "mpm/options.txt", "mpm/frames/*"), "mpm/.run", ("transfer",),
              replaced=("mpm/frames", "mpm/sections.csv", "mpm/bodies.csv"), checkpoint="mpm/checkpoint.h5"),
        Stage("consolidation", "fem_stage", "fem", ("consolidation/*",), "consolidation/.drained", ("shake",),
              replaced=("consolidation/*",)),
        Stage("fem-figures", "fem_figures.py", "", tuple(f"figures/{name}.png" for name in (
            "mesh", "velocity", "excess_pore_pressure_ratio", "displacement_fem", "fem_series", "fem_histories")),
            "figures/.fem", ("shake", "import")),
        Stage("mpm-figures", "mpm_figures.py", "", (*(f"figures/{name}.png" for name in (
            "handover", "displacement_mpm", "runout", "runout_front", "speed", "flow_depth", "sections", "energy")), "figures/flow_depth.csv"),
            "figures/.mpm", ("mpm",), replaced=("figures/sections.png", "figures/flow_depth.*")),
        Stage("film", "animate_runout.py", "", ("figures/runout.mp4", "figures/runout.gif"), "figures/.film", ("mpm",)),
        Stage("report", "report.py", "", ("figures/overview.png", "figures/report.html"), "figures/report.html",
              ("fem-figures", "mpm-figures", "film")),
    )
}
FEM_STAGES = ("mesh", "geostatic", "shake", "import")  # their results do not depend on the time of the hand-over


def asks_for_other_solver(content):
    """Whether mpm.json asks for a solver that mpm_stage hands on to mpm_stage_all (mpm_stage/step/main_solver.cpp)."""
    scheme = content.get("scheme", {})
    return (content.get("dimension", 2), scheme.get("shape_function", "quadratic"), scheme.get("transfer", "aflip")) != (2, "quadratic", "aflip")


def sha256(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def texts_in(content):
    """All texts of a case's content."""
    if isinstance(content, str):
        yield content
    elif isinstance(content, dict):
        for value in content.values():
            yield from texts_in(value)
    elif isinstance(content, list):
        for value in content:
            yield from texts_in(value)


@dataclass
class Place:
    """Where results lie: the finite elements' and those after the hand-over may have folders of their own (T=)."""

    fem: Path
    phase: Path

    def root(self, name):
        return self.fem if name in FEM_STAGES else self.phase


@dataclass
class Chain:
    case_dir: Path
    bin: Path
    size: str = "default"
    time: str = ""
    threads: str = ""
    python: str = "python3"
    film: bool = True
    trust_geometry: bool = False
    settings: dict = field(default_factory=dict)

    def __post_init__(self):
        files = {name: Path(self.case_dir) / f"{name}.json" for name in what_if.STAGES}
        self.files = {name: path for name, path in files.items() if path.exists()}
        if "fem" in self.files and "import" in self.files:
            raise what_if.SettingError(f"{self.case_dir} has fem.json and import.json: a case begins with one of them; keep the one that is meant")
        for stage in self.settings:
            if stage not in self.files:
                raise what_if.SettingError(f"SET: {stage}:{self.settings[stage][0]}: {self.case_dir} has no {stage}.json")
        self._contents, self._records, self._programs = {}, {}, {}

    def has(self, name):
        has_fem = "fem" in self.files
        if name in ("transfer",):
            return "transfer" in self.files and (has_fem or "import" in self.files)
        if name == "consolidation":
            return has_fem
        if name == "fem-figures":
            return has_fem or "import" in self.files
        if name in ("mpm-figures", "film"):
            return "mpm" in self.files and (name != "film" or self.film)
        if name == "report":
            return self.has("fem-figures") and "mpm" in self.files
        return STAGES[name].case in self.files

    def names(self, until="report"):
        """Stages of this case, in order, as far as `until` needs them."""
        wanted = {until} if self.has(until) else set()
        if until == "report":  # all that there is, of a case that has no report too
            wanted |= {name for name in STAGES if name != "consolidation" and self.has(name)}
        for name in reversed(STAGES):
            if name in wanted:
                wanted |= {before for before in STAGES[name].after if self.has(before)}
        return [name for name in STAGES if name in wanted]

    def content(self, case):
        if case not in self._contents:
            self._contents[case] = what_if.case_with(self.files[case], self.settings.get(case, []))
        return self._contents[case]

    def transfer_time(self):
        """T=, or the case's own; as text, "" without either."""
        if self.time:
            return self.time
        return f"{self.content('transfer').get('transfer_time', ''):}" if "transfer" in self.files else ""

    def snapshot(self, place):
        if "import" in self.files:
            return place.fem / "fem" / "snapshot.h5"
        time = self.transfer_time()
        return place.fem / "fem" / (f"snapshot_t{float(time):06.3f}.h5" if time else "snapshot_t?.h5")

    def program_key(self, stage):
        """SHA-256 of the program that computes; of all scripts for pictures, which share modules."""
        program = stage.program
        if program == "mpm_stage" and asks_for_other_solver(self.content("mpm")) and (Path(self.bin) / "mpm_stage_all").exists():
            program = "mpm_stage_all"
        # By the program itself: members of a sweep share the sums, and may ask for another solver each.
        if program not in self._programs:
            if program.endswith(".py"):
                own = {path.name: sha256(path) for path in sorted(PLOT.glob("*.py"))}
                self._programs[program] = hashlib.sha256(json.dumps(own).encode()).hexdigest()
            else:
                self._programs[program] = sha256(Path(self.bin) / program)
        return self._programs[program]

    def record(self, name):
        """The stage's input with its key."""
        if name in self._records:
            return self._records[name]
        stage = STAGES[name]
        record = {"stage": name, "program": self.program_key(stage)}
        if stage.case:
            record["size"] = self.size
            content = self.content(stage.case)
            part = {key: content[key] for key in content if key not in stage.drop and (key in stage.keep or not stage.keep)}
            record["case"] = part
            named = {text: Path(self.case_dir) / text for text in texts_in(part) if re.fullmatch(r"[^\n\0]{1,250}", text)}
            record["files"] = {text: sha256(path) for text, path in sorted(named.items()) if path.is_file()}
        elif (Path(self.case_dir) / "plot.json").exists():
            record["plot"] = sha256(Path(self.case_dir) / "plot.json")
        if name in ("transfer", "consolidation", "fem-figures", "report") and "import" not in self.files:
            record["time"] = float(self.transfer_time() or 0.0)
        record["after"] = {before: self.record(before)["key"] for before in stage.after if self.has(before)}
        record["key"] = hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()
        self._records[name] = record
        return record

    def command(self, name, place):
        """Program and arguments that compute the stage in its place."""
        stage, fem, phase = STAGES[name], place.fem / "fem", place.phase
        figures = phase / "figures"
        time = ["--time", self.transfer_time()] if self.transfer_time() else []
        case = [self.files[stage.case]] if stage.case else []
        command = {
            "mesh": ["mesh", *case, "-o", fem, "--size", self.size, *(["--trust-geometry"] if self.trust_geometry else [])],
            "geostatic": ["geostatic", *case, "--mesh", fem / "mesh.msh", "-o", fem, "--size", self.size],
            "shake": ["shake", *case, "--mesh", fem / "mesh.msh", "--geostatic", fem / "geostatic.h5", "-o", fem, "--size", self.size],
            "import": ["import", *case, "-o", fem / "snapshot.h5"],
            "transfer": ["run", *case, "--snapshot", self.snapshot(place), "-o", phase / "particles.h5", "--size", self.size],
            "mpm": ["run", *case, *(["--particles", phase / "particles.h5"] if self.has("transfer") else []),
                    "-o", phase / "mpm", "--size", self.size],
            "consolidation": ["consolidate", *case, "--mesh", fem / "mesh.msh", "--from", self.snapshot(place),
                              "-o", phase / "consolidation", "--size", self.size],
            "fem-figures": [fem, "--case", self.case_dir, *time, "-o", figures],
            "mpm-figures": [phase / "mpm", "--case", self.case_dir, "-o", figures],
            "film": [phase / "mpm", "--case", self.case_dir, "-o", figures / "runout.mp4"],
            "report": [place.fem, "--phase", phase, "--case", self.case_dir, *time, "-o", figures / "report.html"],
        }[name]
        if stage.case:
            command = [Path(self.bin) / stage.program, *command]
            for text in self.settings.get(stage.case, []):
                command += ["--set", text]
            command += ["--threads", self.threads] if self.threads else []
        else:
            command = [self.python, Path("cases/plot") / stage.program, *command]
        return [str(word) for word in command]


SIGNALS = []  # that call() has passed on: a program that ended after one was interrupted and has not failed


def call(command):
    """Runs a command to its end, however this process is asked to stop: the program keeps its state and says so."""
    import signal

    process = None
    asked = []

    def pass_on(number, _):
        asked.append(number)
        SIGNALS.append(number)
        # Ctrl-C reaches the program by itself.
        if process is not None and number == signal.SIGTERM:
            process.send_signal(number)

    before = {number: signal.signal(number, pass_on) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        process = subprocess.Popen(command)
        if signal.SIGTERM in asked:
            process.send_signal(signal.SIGTERM)
        status = process.wait()
    except FileNotFoundError:
        print(f"{command[0]} is missing: make -f Makefile.cases build", flush=True)
        return 1
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return status if status >= 0 else 128 - status
