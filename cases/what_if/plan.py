"""What a sweep has to compute: the members' stages by the keys of their inputs (cases/run/stages.py), each once, less what is there.

The store, <results>/store/<stage>-<key>/, holds what is computed for sweeps, whichever sweep asked for it. A member's folder keeps member.json
(numbers), front.csv and profile.csv; stages before the runout stay only where members share them.
"""

import json
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import paths  # noqa: F401
import design as designs
import named
from case_part import read_case
from headline import MEASURE
from settings import STAGES as CASE_FILES
from stage import read_json, results_of
from stages import Chain

KEY_LENGTH = 20
# Frames at the beginning and the end: the profile comes from them, and they go.
FRUGAL = {"/output/frame_interval": 1e9}


@dataclass
class Member:
    number: int
    values: dict
    settings: dict
    keys: dict  # stage -> key
    identity: str = ""

    @property
    def key(self):
        return self.keys["mpm"]


@dataclass
class Unit:
    """One stage to be computed, for one member or for several."""

    stage: str
    key: str
    settings: dict
    after: list = field(default_factory=list)  # (stage, key) of other units
    sole: list = field(default_factory=list)  # folders of the store that go with this member
    members: set = field(default_factory=set)


def folder_of(store, stage, key):
    return Path(store) / f"{stage}-{key[:KEY_LENGTH]}"


def with_frugal_output(settings):
    own = {text.partition("=")[0] for text in settings.get("mpm", [])}
    more = [f"{pointer}={json.dumps(value)}" for pointer, value in FRUGAL.items() if pointer not in own and "/output" not in own]
    return {**settings, "mpm": settings.get("mpm", []) + more}


def chain_with(base, settings):
    """The chain of a member; programs are summed once for all."""
    chain = Chain(base.case_dir, base.bin, base.size, base.time, base.threads, base.python, False, base.trust_geometry, settings)
    chain._programs = base._programs
    return chain


def members_of(design, base):
    contents = {stage: read_case(Path(base.case_dir) / f"{stage}.json") for stage in CASE_FILES if (Path(base.case_dir) / f"{stage}.json").exists()}
    found = []
    for number, values in enumerate(design.members, 1):
        settings = with_frugal_output(designs.settings_of(design, values, contents))
        chain = chain_with(base, settings)
        found.append(Member(number, values, settings, {name: chain.record(name)["key"] for name in chain.names("mpm")}))
    return found


def is_done(store, key):
    """Whether the member's numbers are there, measured as headline.py measures now."""
    return (read_json(folder_of(store, "mpm", key) / "member.json") or {}).get("measure") == MEASURE


def tidy(store, key):
    """Removes what a killed process left beside a member's results."""
    shutil.rmtree(folder_of(store, "mpm", key) / "work", ignore_errors=True)


def there_already(stage, key, store, donors):
    folders = [folder_of(store, stage, key), *(folder for _, folder in donors)]
    return any(results_of(folder, stage, key) is not None for folder in folders)


def has_failed(member, store):
    """Whether it, or a stage that it needs, has failed; nothing is known of it without."""
    return not is_done(store, member.key) and any((folder_of(store, *name) / "failed.json").exists() for name in member.keys.items())


def units_of(members, store, fem, phase):
    """Units that are missing, in the order of the stages; the last ones are the members'. What has failed is not missing (forget_failures)."""
    donors = [(words, folder) for words, folder in named.donors(fem, phase) if Path(store) not in folder.parents]
    missing = {member.key: member for member in members if not is_done(store, member.key) and not has_failed(member, store)}
    users = {}
    for member in members:
        for stage, key in member.keys.items():
            users.setdefault((stage, key), set()).add(member.key)
    units, found_before = {}, {}
    for member in missing.values():
        before = []
        for stage, key in member.keys.items():
            name = (stage, key)
            if stage != "mpm" and name not in found_before:
                found_before[name] = there_already(stage, key, store, donors)
            if stage == "mpm" or not found_before[name]:
                unit = units.setdefault(name, Unit(stage, key, member.settings, list(before)))
                unit.members.add(member.key)
                before = before + [name]
        units["mpm", member.key].sole = [str(folder_of(store, stage, key)) for stage, key in member.keys.items()
                                         if stage != "mpm" and len(users[stage, key]) == 1]
    order = {stage: rank for rank, stage in enumerate(dict.fromkeys(stage for member in members for stage in member.keys))}
    return sorted(units.values(), key=lambda unit: order[unit.stage])


def write_table(path, units):
    """One line a unit: what unit.py needs to know. Returns {(stage, key): line, from 1}."""
    path = Path(path)
    lines = {(unit.stage, unit.key): line for line, unit in enumerate(units, 1)}
    with path.open("w") as file:
        for unit in units:
            json.dump({"stage": unit.stage, "key": unit.key, "settings": unit.settings, "sole": unit.sole}, file)
            file.write("\n")
    return lines


def forget_failures(members, store):
    """What failed is tried again: nothing is known of it any more."""
    for name in {name for member in members if not is_done(store, member.key) for name in member.keys.items()}:
        (folder_of(store, *name) / "failed.json").unlink(missing_ok=True)


def outcome(member, store):
    """(state, content): done with member.json's content, failed with failed.json's, missing."""
    content = read_json(folder_of(store, "mpm", member["keys"]["mpm"]) / "member.json")
    if content is not None and content.get("measure") == MEASURE:
        return "done", content
    for stage, key in member["keys"].items():
        content = read_json(folder_of(store, stage, key) / "failed.json")
        if content is not None:
            return "failed", content
    return "missing", {}
