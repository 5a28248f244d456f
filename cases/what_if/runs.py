"""Runs of a case that are there: the base run and named ones, what they were computed from, and what they came to."""

import difflib
import json
from dataclasses import dataclass, field
from pathlib import Path

import paths  # noqa: F401
import headline
import named
from chain_files import series
from stage import read_json
from stages import STAGES, Place


class RunError(Exception):
    """A run that cannot be shown."""


@dataclass
class Run:
    name: str
    place: Place
    settings: list  # words of SET=, as given
    numbers: dict  # headline numbers
    flow: object  # profile_of_flow.Flow, or None
    front: dict  # columns of front.csv, or None
    ended: str = ""  # stop_reason
    inputs: dict = field(default_factory=dict)  # "mpm:/residual_strength/factor" -> value


def flattened(content, way):
    """{pointer: value} of every leaf."""
    if isinstance(content, dict) and content:
        return {key: value for name, part in content.items() for key, value in flattened(part, f"{way}/{name}").items()}
    if isinstance(content, list) and any(isinstance(part, (dict, list)) for part in content):
        return {key: value for index, part in enumerate(content) for key, value in flattened(part, f"{way}/{index}").items()}
    return {way: content}


def inputs_of(place):
    """All that the run depends on, as its stamps have it: values of case files by pointer, sums of the files named there and of the
    programs."""
    found = {}
    for name, stage in STAGES.items():
        stamp = read_json(place.root(name) / ".inputs" / f"{name}.json")
        if stamp is None or not stage.case or name == "consolidation":
            continue
        for key, value in flattened(stamp.get("case", {}), f"{stage.case}:").items():
            # "sizes" and the like are read by more than one stage; they are equal there.
            found[key] = value
        for file, total in stamp.get("files", {}).items():
            found[f"{file} (SHA-256)"] = total[:12]
        found[f"{stage.program} (SHA-256)"] = stamp["program"][:12]
        if "time" in stamp:
            found["T= (s)"] = stamp["time"]
    return found


def differences(runs):
    """{key: [value of each run]} of what is not the same in all of them; None where a run lacks it."""
    keys = dict.fromkeys(key for run in runs for key in run.inputs if not key.endswith(":/title"))
    values = {key: [run.inputs.get(key) for run in runs] for key in keys}
    return {key: row for key, row in values.items() if len({json.dumps(value, sort_keys=True) for value in row}) > 1}


def available(phase):
    """Names of the runs that have a runout."""
    found = ["base"] if (Path(phase) / "mpm" / "summary.json").exists() else []
    return found + [name for name in named.runs_in(phase) if (named.folder_of(phase, name) / "mpm" / "summary.json").exists()]


def load(name, fem, phase):
    """The run of this name."""
    there = available(phase)
    root = Path(phase) if name == "base" else named.folder_of(phase, name)
    place = Place(Path(fem), root) if name == "base" else Place(root, root)
    if name not in there:
        near = difflib.get_close_matches(name, there, 3, 0.5)
        listed = ", ".join(there) or "none yet"
        hint = f" Did you mean {' or '.join(near)}?" if near else ""
        state = "has no runout yet" if name == "base" or root.exists() else "is not there"
        raise RunError(f"RUNS: run '{name}' {state} in {phase}.{hint} Runs that can be compared: {listed}")
    if name != "base" and not (root / "run.json").exists():
        raise RunError(f"RUNS: run '{name}' is not complete: make it once more, RUN={name}")
    if not (root / "mpm" / ".run").exists():
        raise RunError(f"RUNS: {root / 'mpm'}: the runout is not complete; compute it once more")
    try:
        numbers, flow = headline.of_run(root, place.fem)
    except SystemExit:  # chain_files has said which file
        raise RunError(f"RUNS: run '{name}' cannot be read; compute it once more") from None
    settings = (read_json(root / "run.json") or {}).get("settings", []) if name != "base" else []
    return Run(name, place, settings, numbers, flow, series(root / "mpm" / "front.csv"),
               (read_json(root / "mpm" / "summary.json") or {}).get("stop_reason", ""), inputs_of(place))


def load_all(words, fem, phase):
    """The runs named in RUNS=; all that there are when it is empty."""
    names = list(dict.fromkeys(words.split())) or available(phase)
    if len(names) < 2:
        found = f"only {names[0]}" if names else "none"
        raise RunError(f"RUNS: two runs at least are compared, {found} is there; make another: RUN=name SET='mpm:/...=value'")
    problems, runs = [], []
    for name in names:
        try:
            runs.append(load(name, fem, phase))
        except RunError as problem:
            problems.append(str(problem))
    if problems:
        raise RunError("\n".join(problems))
    return runs


def hand_over_time(run):
    """s since the start of the motion at which the runout begins; 0 for cases without a hand-over."""
    return run.flow.since if run.flow is not None else float(run.inputs.get("T= (s)", 0.0))
