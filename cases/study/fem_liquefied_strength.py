#!/usr/bin/env python3
"""What the residual strength of liquefied soil and softening by element height make of the shaking, by mesh, with members.

    fem_liquefied_strength.py build/bin/fem_stage cases -o out/study/strength [--case mochikoshi] [--sizes coarse default fine]
        [--variants off floor both_1.5 ...] [--members 3] [--jobs 1] [--table]

Variants: `off` (the case as it is), `floor` (residual_strength as in the case's transfer.json), `height_H`
(softening/reference_height H m alone), `both_H` (both); with `_from_G` softening/from_shear_strain G, with `_strained_G` a floor that
begins at a shear strain of G, not at an r_u. Members are the
same run with the motion times 1, 1 + 1e-4, 1 - 1e-4, 1 + 2e-4 ... Each run takes one thread; what is there already is not
run again. --table prints means and standard deviations of all that is there, as Markdown.
"""

import argparse
import concurrent.futures
import json
import pathlib
import re
import resource
import subprocess
import sys

import h5py
import numpy as np

SIZES = ("coarse", "default", "fine")


def read_case(path):
    return json.loads(re.sub(r"(?m)^\s*//.*$", "", path.read_text()))


def scales(members):
    """Of the motion, less 1."""
    return [0.0] + [s * k * 1e-4 for k in range(1, members) for s in (1, -1)][: members - 1]


def changed(scene, variant, transfer):
    """The case with a variant's options in its tailings; every material that transfer.json gives a residual strength."""
    words = variant.split("_")
    for rule in transfer["rules"]:
        if "residual_strength" not in rule:
            continue
        region = rule["when"]["region"]
        material = scene["materials"][scene["regions"][region]["material"]]
        if words[0] in ("floor", "both"):
            material["residual_strength"] = dict(rule["residual_strength"])
            if "strained" in words:  # no r_u is above 2
                material["residual_strength"]["trigger"] = {"excess_pore_pressure_ratio": 2.0,
                                                            "shear_strain": float(words[words.index("strained") + 1])}
        if words[0] in ("height", "both"):
            material["softening"] = {"reference_height": float(words[1])}
            if "from" in words:
                material["softening"]["from_shear_strain"] = float(words[words.index("from") + 1])
    return scene


def figures(folder, scene):
    """By snapshot time: largest displacement, settlement of the crest, mass that moved over 0.25, 1 and 2 m."""
    history = np.genfromtxt(folder / "history.csv", delimiter=",", names=True, deletechars="")
    out = {}
    for time in scene["output"]["snapshots"]:
        with h5py.File(folder / f"snapshot_t{time:06.3f}.h5") as f:
            data = f["VTKHDF"]
            points, cells = data["Points"][()][:, :2], data["Connectivity"][()].reshape(-1, 4)
            moved = np.linalg.norm(data["PointData/displacement"][()], axis=1)
            density, thickness = data["CellData/density"][()], data["CellData/thickness"][()]
        soil = thickness < 10.0  # not the free field's columns
        x, y = points[cells, 0], points[cells, 1]
        area = 0.5 * np.abs((x[:, 2] - x[:, 0]) * (y[:, 3] - y[:, 1]) - (x[:, 3] - x[:, 1]) * (y[:, 2] - y[:, 0]))
        mass, centre = 1e-3 * density * area, moved[cells].mean(axis=1)
        out[f"{time:g}"] = {
            "displacement_m": float(moved[np.unique(cells[soil])].max()),
            "crest_settlement_m": float(-np.interp(time, history["time_s"], history["crest_uy_m"])),
            **{f"moved_{d:g}_t_per_m": float(mass[soil & (centre > d)].sum()) for d in (0.25, 1.0, 2.0)}}
    return out


def run(program, cases, case, output, size, variant, scale, step=None):
    name = f"{case}/{size}/{variant}" + (f"_step_{step:g}" if step else "") + f"/{scale:+g}"
    folder = output / name
    result = folder / "figures.json"
    if result.exists():
        return json.loads(result.read_text())
    folder.mkdir(parents=True, exist_ok=True)
    source = cases / case
    scene = changed(read_case(source / "fem.json"), variant, read_case(source / "transfer.json"))
    scene["mesh"]["geometry"] = str((source / scene["mesh"]["geometry"]).resolve())
    scene["shake"]["motion"] = str((source / scene["shake"]["motion"]).resolve())
    scene["shake"]["peak_acceleration"] *= 1.0 + scale
    if step:
        scene["shake"]["time_step"] = step
    duration = scene["shake"]["duration"]
    scene["output"]["snapshots"] = [t for t in (4, 5, 6, 8, 10, 12, 16) if t <= duration]
    (folder / "fem.json").write_text(json.dumps(scene, indent=1))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, "run", str(folder / "fem.json"), "-o", str(folder), "--quiet", "--size", size, "--threads", "1"],
                          capture_output=True, text=True)
    if done.returncode != 0:
        print(f"{name} failed: {done.stderr[-400:]}", flush=True)
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads((folder / "summary.json").read_text())
    energy = summary["energy_J"]
    row = {"case": case, "size": size, "variant": variant, "scale": scale, "step": step or scene["shake"]["time_step"],
           "elements": summary["elements"], "at": figures(folder, scene),
           # Of one of several runs at a time it is not known whose seconds these are.
           "children_processor_s": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
           "wall_s": summary["seconds"]["total"], "counts": summary["counts"], "energy_J": energy,
           "liquefied_depth_m": summary["liquefied_depth_m"], "mean_r_u": summary["mean_excess_pore_pressure_ratio"]}
    for large in [*folder.glob("*.h5"), *folder.glob("*.msh")]:
        large.unlink()
    result.write_text(json.dumps(row, indent=1) + "\n")
    print(f"{name}: {row['wall_s']:.0f} s, largest displacement "
          + ", ".join(f"{t} s {v['displacement_m']:.3f} m" for t, v in row["at"].items()), flush=True)
    return row


def mean(values, digits):
    values = np.array(values)
    text = f"{values.mean():.{digits}f}"
    return text + (f" ± {values.std(ddof=1):.{digits}f}" if len(values) > 1 else "")


def table(output, case):
    rows = [json.loads(p.read_text()) for p in sorted((output / case).glob("*/*/*/figures.json"))]
    variants = sorted({(r["variant"], r["step"]) for r in rows})
    times = [t for t in rows[0]["at"] if float(t) >= 5 or case != "mochikoshi"]
    print("| | mesh | members | " + " | ".join(f"{t} s" for t in times) + f" | crest settlement {times[-1]} s | moved > 1 m, t/m |")
    print("|---" * (5 + len(times)) + "|")
    for variant, step in variants:
        for size in SIZES:
            of = [r for r in rows if (r["variant"], r["step"], r["size"]) == (variant, step, size)]
            if of:
                print(f"| {variant} {step:g} | {size} | {len(of)} | "
                      + " | ".join(mean([r["at"][t]["displacement_m"] for r in of], 3 if float(t) < 9 else 2) for t in times)
                      + " | " + mean([r["at"][times[-1]]["crest_settlement_m"] for r in of], 2)
                      + " | " + mean([r["at"][times[-1]]["moved_1_t_per_m"] for r in of], 0) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--case", default="mochikoshi")
    parser.add_argument("--sizes", nargs="+", choices=SIZES, default=list(SIZES))
    parser.add_argument("--variants", nargs="+", default=["off", "floor", "both_1.5"])
    parser.add_argument("--members", type=int, default=3)
    parser.add_argument("--step", type=float, help="s, in place of the case's")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()
    if arguments.table:
        return table(arguments.output, arguments.case)
    jobs = [(size, variant, scale) for scale in scales(arguments.members) for variant in arguments.variants for size in arguments.sizes]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = list(pool.map(lambda job: run(arguments.program, arguments.cases.resolve(), arguments.case, arguments.output,
                                                *job, arguments.step), jobs))
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
