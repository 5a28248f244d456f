"""The members of a sweep as arrays, and as the one CSV and the one HDF5 file that a sweep leaves."""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

import paths  # noqa: F401
import plan
from chain_files import series
from headline import HEADLINES
from stage import read_json

WANTED = 0.3  # m: flow deeper than this is asked about along the flow
ONE_BED = 1.0  # m: members whose beds differ by more flow over ground of their own


@dataclass
class Table:
    plan: dict  # plan.json
    state: list  # done, failed, missing
    content: list  # member.json or failed.json of each member
    values: dict  # parameter -> list
    numbers: dict  # headline name -> array, NaN where a member has none
    profiles: dict  # x, surface, initial_surface, bed, depth, height, initial_height, one_bed; empty without profiles

    @property
    def done(self):
        return np.array([state == "done" for state in self.state])

    @property
    def draws(self):
        """Mask of the members that are draws of their own: of a "saltelli" design its two base samples, without their mixtures."""
        number = np.arange(len(self.state))
        return number % (len(self.parameters) + 2) < 2 if self.plan["design"] == "saltelli" else np.full(len(number), True)

    @property
    def parameters(self):
        return self.plan["parameters"]


def on_columns(table, x):
    """The profile's columns at x; a member of another size of particles is interpolated."""
    if len(table["x_m"]) > 1 and np.isclose(np.diff(table["x_m"][:2]), x[1] - x[0]):
        where = np.round((table["x_m"] - x[0]) / (x[1] - x[0])).astype(int)
        found = {name: np.full(len(x), np.nan) for name in table}
        for name, values in table.items():
            found[name][where] = values
        return found
    return {name: np.interp(x, table["x_m"], values, np.nan, np.nan) for name, values in table.items()}


def profiles_of(folders):
    """Profiles of members over one x (m), the columns of the widest: arrays (members, columns). Where a member has no soil its surface
    is the bed (NaN without one), its depth and its height over the bed 0; members without a profile are NaN throughout. Where beds of
    members differ there is no bed of all: NaN, and a member's own where it is known."""
    tables = [series(folder / "profile.csv") if folder else None for folder in folders]
    given = [table for table in tables if table is not None]
    if not given:
        return {}
    width = max(np.diff(table["x_m"][:2]).max(initial=0.0) for table in given) or 1.0
    low = int(np.round(min(table["x_m"].min() for table in given) / width - 0.5))
    high = max(int(np.round(max(table["x_m"].max() for table in given) / width - 0.5)), low + 1)
    x = (np.arange(low, high + 1) + 0.5) * width
    columns = [None if table is None else on_columns(table, x) for table in tables]
    bed, lowest = np.full(len(x), np.nan), np.full(len(x), np.nan)
    for own in columns:
        if own is not None:
            bed, lowest = np.fmax(bed, own["bed_m"]), np.fmin(lowest, own["bed_m"])
    parted = bed - lowest > ONE_BED
    bed = np.where(parted, np.nan, bed)
    found = {"x": x, "bed": bed, "one_bed": not np.any(parted)}
    for name, column in (("height", "surface_m"), ("initial_height", "initial_surface_m")):
        found[name] = np.array([np.full(len(x), np.nan) if own is None else np.where(np.isnan(own[column]), 0.0, own[column] - own["bed_m"]) for own in columns])
    for own in columns:
        if own is not None:
            own["bed_m"] = np.where(np.isnan(own["bed_m"]), bed, own["bed_m"])
    for name, column in (("surface", "surface_m"), ("initial_surface", "initial_surface_m"), ("depth", "flow_depth_m")):
        found[name] = np.array([np.full(len(x), np.nan) if own is None else
                                np.where(np.isnan(own[column]), 0.0 if name == "depth" else own["bed_m"], own[column]) for own in columns])
    return found


def load(folder):
    """Table of a sweep's folder, as far as its members are computed."""
    content = read_json(Path(folder) / "plan.json")
    if content is None:
        raise OSError(f"{folder}: there is no plan.json; make the sweep first")
    store = Path(content["store"])
    outcomes = [plan.outcome(member, store) for member in content["members"]]
    state = [outcome[0] for outcome in outcomes]
    values = {p["name"]: [member["values"][p["name"]] for member in content["members"]] for p in content["parameters"]}
    numbers = {}
    for headline in HEADLINES:
        found = [outcome[1].get("numbers", {}).get(headline.name) if outcome[0] == "done" else None for outcome in outcomes]
        numbers[headline.name] = np.array([np.nan if value is None else value for value in found])
    folders = [plan.folder_of(store, "mpm", member["keys"]["mpm"]) if s == "done" else None for member, s in zip(content["members"], state)]
    return Table(content, state, [outcome[1] for outcome in outcomes], values, numbers, profiles_of(folders))


def text_of(value):
    if value is None:
        return "-"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return f"{value:.12g}"
    return value if isinstance(value, str) else json.dumps(value)


def text_of_choice(p, value):
    """What tables and pictures call a parameter's value."""
    return p["labels"][p["choices"].index(value)] if p.get("labels") and value in p["choices"] else text_of(value)


def used_headlines(table):
    return [headline for headline in HEADLINES if np.isfinite(table.numbers[headline.name]).any()]


def write_csv(path, table):
    headlines = used_headlines(table)
    with Path(path).open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["member", "state", "key", *table.values, *(headline.name for headline in headlines), "stop_reason"])
        for row, member in enumerate(table.plan["members"]):
            numbers = [table.numbers[headline.name][row] for headline in headlines]
            writer.writerow([member["number"], table.state[row], member["keys"]["mpm"][:plan.KEY_LENGTH], *(text_of_choice(p, table.values[p["name"]][row]) for p in table.parameters),
                             *("" if np.isnan(number) else f"{number:.12g}" for number in numbers), table.content[row].get("stop_reason", "")])


def write_failures(path, table):
    """CSV of the members that failed, with the reason and where the program's words are; no file when there are none."""
    failed = [row for row, state in enumerate(table.state) if state == "failed"]
    Path(path).unlink(missing_ok=True)
    if failed:
        with Path(path).open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["member", "stage", "reason", "log"])
            for row in failed:
                content = table.content[row]
                writer.writerow([table.plan["members"][row]["number"], content["stage"], content["reason"], content["log"]])


def write_hdf5(path, table):
    """Every dataset has `unit` and `description`; equal sweeps make equal bytes."""
    temporary = Path(path).with_suffix(".part")
    with h5py.File(temporary, "w") as file:
        def put(name, values, unit, description):
            data = np.array([text_of(v).encode() for v in values]) if isinstance(values, list) else values
            dataset = file.create_dataset(name, data=data)
            dataset.attrs["unit"], dataset.attrs["description"] = np.bytes_(unit), np.bytes_(description)

        file.attrs["format"] = np.bytes_("tailrun-sweep")
        file.attrs["format_version"] = 1.0
        put("members/number", np.array([member["number"] for member in table.plan["members"]]), "1", "number of the member")
        put("members/state", list(table.state), "", "done, failed or missing")
        put("members/key", [member["keys"]["mpm"] for member in table.plan["members"]], "", "SHA-256 of the input of the runout")
        for p in table.parameters:
            numeric = p["numeric"]
            values = np.array(table.values[p["name"]], float) if numeric else [text_of_choice(p, value) for value in table.values[p["name"]]]
            what = "multiplies " if p["scales"] else ""
            put(f"parameters/{p['name']}", values, "1" if p["scales"] else "as in the case file", what + ", ".join(p["keys"]))
        for headline in used_headlines(table):
            put(f"numbers/{headline.name}", table.numbers[headline.name], headline.unit, headline.label)
        if table.profiles:
            put("profiles/x", table.profiles["x"], "m", "middle of the columns of soil")
            put("profiles/bed", table.profiles["bed"], "m", f"ground that soil flows over, NaN where members differ by more than {ONE_BED:g} m")
            for name, words in (("initial_surface", "highest soil at the hand-over"), ("surface", "highest soil at the end, the bed without"),
                                ("depth", "volume of what flowed over the column's width")):
                put(f"profiles/{name}", table.profiles[name], "m", words + "; (members, columns)")
    temporary.replace(path)
