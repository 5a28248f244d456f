#!/usr/bin/env python3
"""The overview picture and a one-page report (HTML) of a case: its pictures and the numbers of its summaries.

    report.py out/mochikoshi --phase out/mochikoshi --case cases/mochikoshi --time 16 -o out/mochikoshi/figures/report.html
"""

import argparse
import html
import os
from pathlib import Path

import chain_files as chain
import results
import runout_plot as runout
import style
from overview import plot_overview
from runout_marks import Marks

SECTIONS = [
    ("The chain at a glance", [("overview.png", "r_u at the hand-over, the particles, the runout")]),
    (
        "Shaking and liquefaction (fem_stage)",
        [
            ("mesh.png", "mesh with its regions and the phreatic line"),
            ("velocity.png", "velocities on the deformed mesh at the hand-over"),
            ("excess_pore_pressure_ratio.png", "excess pore pressure ratio at the hand-over"),
            ("displacement_fem.png", "displacement at the end of the FEM phase"),
            ("fem_series.png", "liquefied depth, pore pressure, displacement and mesh quality over time"),
            ("fem_histories.png", "displacement of the named points"),
        ],
    ),
    (
        "Runout (transfer_tool, mpm_stage)",
        [
            ("handover.png", "particles by material"),
            ("displacement_mpm.png", "displacement added by the MPM phase"),
            ("runout.png", "runout in stages"),
            ("runout_front.png", "runout from the toe, highest ground over the dam, and speed over time"),
            ("speed.png", "speed at four moments"),
            ("flow_depth.png", "final ground, and depth of what flowed"),
            ("sections.png", "discharge, depth and speed at the sections that mpm.json names, and what has passed"),
            ("energy.png", "energy ledger"),
        ],
    ),
]
STYLE = """body{font:15px/1.45 sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#222}
img,video{max-width:100%}table{border-collapse:collapse}td,th{padding:.2em .8em;border-bottom:1px solid #ddd;text-align:left}
figure{margin:1.2em 0}figcaption{color:#555}"""


IMPORTED = "The imported state (import.json)"  # in place of the second section's heading


def page(title, rows, figures, imported=False):
    parts = [f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title>"]
    parts.append(f"<style>{STYLE}</style><h1>{html.escape(title)}</h1>")
    parts.append("<table><tr><th>stage<th>quantity<th>value</tr>")
    for stage, what, value, unit in rows:
        shown = html.escape(f"{value} {unit if unit != '1' else ''}".strip())
        parts.append(f"<tr><td>{stage}<td>{html.escape(what)}<td>{shown}</tr>")
    parts.append("</table>")
    for heading, pictures in SECTIONS:
        shown = [(name, caption) for name, caption in pictures if (figures / name).exists()]
        if not shown:
            continue
        if imported and "fem_stage" in heading:
            heading = IMPORTED
        parts.append(f"<h2>{html.escape(heading)}</h2>")
        for name, caption in shown:
            caption = html.escape(caption)
            parts.append(f"<figure><img src='{name}' alt='{caption}'><figcaption>{caption}</figcaption></figure>")
    if (figures / "runout.mp4").exists():
        parts.append("<h2>Film</h2><video src='runout.mp4' controls></video>")
    elif (figures / "runout.gif").exists():
        parts.append("<h2>Film</h2><img src='runout.gif' alt='runout'>")
    return "\n".join(parts) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="out/<case>[-<size>]")
    parser.add_argument("--phase", type=Path, help="folder of particles, mpm and figures (the same without T=)")
    parser.add_argument("--case", type=Path, required=True)
    parser.add_argument("--time", type=float)
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    phase = arguments.phase or arguments.folder
    plt = style.pyplot()
    snapshot = chain.snapshot_at(arguments.folder / "fem", arguments.time)
    first, last, _ = runout.first_and_last(phase / "mpm")
    options = chain.plot_options(arguments.case)
    plot_overview(plt, snapshot, first, last, Marks(first, phase / "mpm"), options, arguments.output.parent / "overview.png")
    title = chain.summary(phase / "mpm" / "summary.json").get("title", arguments.case.name)
    text = page(title, results.collect(arguments.folder, phase), arguments.output.parent, snapshot.imported)
    temporary = arguments.output.with_name(".part_" + arguments.output.name)
    temporary.write_text(text)
    os.replace(temporary, arguments.output)


if __name__ == "__main__":
    main()
