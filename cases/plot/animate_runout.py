#!/usr/bin/env python3
"""A film of the runout: particles by material over the terrain. MP4 by ffmpeg, or an animated GIF where there is none.

    animate_runout.py out/mochikoshi/mpm --case cases/mochikoshi -o out/mochikoshi/figures/runout.mp4
"""

import argparse
import os
import shutil
from pathlib import Path

import chain_files as chain
import field_plot as fields
import runout_plot as runout
import style
from palette import Palette
from runout_marks import Marks


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="results of mpm_stage")
    parser.add_argument("--case", type=Path, help="the case's folder, for plot.json")
    parser.add_argument("--fps", type=int, default=8)
    parser.add_argument("-o", "--output", type=Path, required=True)
    arguments = parser.parse_args()
    plt = style.pyplot()
    from matplotlib.animation import FFMpegWriter, PillowWriter

    plt.rcParams["figure.constrained_layout.use"] = False
    first, last, paths = runout.first_and_last(arguments.folder)
    view = runout.runout_view(first, last, chain.plot_options(arguments.case))
    figure, axis = plt.subplots(figsize=(style.WIDTH, style.panel_height(view) + 0.9))
    figure.subplots_adjust(left=0.07, right=0.99, top=0.93, bottom=0.36)
    palette = Palette(first)
    dots = runout.draw_materials(figure, axis, first, view, palette)
    Marks(first, arguments.folder).draw_ground(axis)
    palette.legend(axis, first)

    output = arguments.output
    if shutil.which("ffmpeg"):
        # yuv420p, which every player reads, needs even numbers of pixels.
        writer = FFMpegWriter(
            fps=arguments.fps, extra_args=["-pix_fmt", "yuv420p", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white"]
        )
    else:
        output = output.with_suffix(".gif")
        writer = PillowWriter(fps=arguments.fps)
        print(f"ffmpeg is missing: writing {output}")
    temporary = output.with_name(".part_" + output.name)
    output.parent.mkdir(parents=True, exist_ok=True)
    square_metre = style.marker_area(figure, axis, 1.0)
    with writer.saving(figure, str(temporary), dpi=100):
        for path in paths:
            particles = chain.Particles(path)
            dots.set_offsets(particles.position)
            dots.set_sizes(fields.marker_areas(particles, square_metre))
            if len(particles.position) != len(dots.get_facecolors()):
                dots.set_facecolors(palette.colours(particles))
            axis.set_title(f"t = {particles.time:.1f} s")
            writer.grab_frame()
        for _ in range(2 * arguments.fps):
            writer.grab_frame()
    os.replace(temporary, output)


if __name__ == "__main__":
    main()
