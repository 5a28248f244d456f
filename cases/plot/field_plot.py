"""Fields on quadrilaterals and on particles."""

import numpy as np

import style


def quad_collection(points, quads, **options):
    from matplotlib.collections import PolyCollection

    return PolyCollection(points[quads], **options)


def draw_cells(axis, points, quads, values, mesh=True, **scale):
    """Quadrilaterals coloured by one value each. Returns the mappable."""
    edges = {"edgecolors": (0, 0, 0, 0.18), "linewidths": 0.25} if mesh else {"edgecolors": "face", "linewidths": 0.2}
    collection = quad_collection(points, quads, array=values, cmap=scale["cmap"], **edges)
    collection.set_clim(scale.get("vmin"), scale.get("vmax"))
    axis.add_collection(collection)
    return collection


def draw_nodal(axis, points, quads, values, **scale):
    """A nodal field, linear over each quadrilateral's two triangles. Returns the mappable."""
    from matplotlib.tri import Triangulation

    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return axis.tripcolor(Triangulation(points[:, 0], points[:, 1], triangles), values, shading="gouraud", **scale)


def draw_mesh(axis, points, quads, colour=(0, 0, 0, 0.35), width=0.3):
    axis.add_collection(quad_collection(points, quads, facecolors="none", edgecolors=colour, linewidths=width))


def draw_regions(axis, snapshot, points, mesh=True):
    """Elements in their region's colour; returns legend handles."""
    from matplotlib.patches import Patch

    handles = []
    for index, name in enumerate(snapshot.region_names):
        mask = snapshot.region_id == index
        if not mask.any():
            continue
        colour = style.region_colour(name, index)
        edge = "0.35" if mesh else colour
        axis.add_collection(
            quad_collection(points, snapshot.quads[mask], facecolors=colour, edgecolors=edge, linewidths=0.25)
        )
        handles.append(Patch(facecolor=colour, edgecolor="0.35", label=name.replace("_", " ")))
    return handles


def region_outlines(snapshot):
    """Edges (k, 2) between regions and on the outside, as node pairs."""
    edges = np.sort(np.concatenate([snapshot.quads[:, [a, (a + 1) % 4]] for a in range(4)]), axis=1)
    region = np.tile(snapshot.region_id, 4)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, region = edges[order], region[order]
    same = np.all(edges[1:] == edges[:-1], axis=1)
    paired = np.zeros(len(edges), bool)
    paired[1:] |= same
    paired[:-1] |= same
    differ = np.concatenate([same & (region[1:] != region[:-1]), [False]])
    return edges[~paired | differ]


def draw_outlines(axis, snapshot, points, colour="0.2", width=0.7):
    from matplotlib.collections import LineCollection

    axis.add_collection(LineCollection(points[region_outlines(snapshot)], colors=colour, linewidths=width))


def draw_phreatic_line(axis, snapshot, label=True):
    if snapshot.phreatic_line.size:
        axis.plot(*snapshot.phreatic_line.T, color="#1f5fbf", lw=1.2, ls="--", label="phreatic line" if label else None)


def draw_particles(figure, axis, particles, values, **options):
    """Particles as squares of their own volume; `values` are numbers (with cmap, vmin, vmax) or colours."""
    return axis.scatter(
        particles.position[:, 0],
        particles.position[:, 1],
        c=values,
        s=marker_areas(particles, style.marker_area(figure, axis, 1.0)),
        marker="s",
        linewidths=0,
        **options,
    )


def marker_areas(particles, square_metre):
    """Marker areas (points^2), a little more than each particle's own so that no grid of gaps shows between them;
    `square_metre` is style.marker_area of 1 m."""
    volume = np.minimum(particles.data["volume"], 4.0 * particles.size**2)  # a particle that has blown up hides nothing
    return 1.7 * square_metre * volume


def draw_terrain(axis, particles, floor):
    for line in particles.terrain.values():
        order = np.abs(np.diff(line[:, 0])).sum() > np.abs(np.diff(line[:, 1])).sum()
        axis.plot(line[:, 0], line[:, 1], color="0.25", lw=0.9)
        if order:
            axis.fill_between(line[:, 0], line[:, 1], floor, color="0.9", lw=0)


def dam_view(snapshot, options):
    """Where the dam is: plot.json's dam_view, or everything but free-field columns, or where it moves most."""
    if "dam_view" in options:
        return options["dam_view"]
    inside = snapshot.in_regions(lambda name: not name.startswith("freefield"))
    points = snapshot.position[np.unique(snapshot.quads[inside])]
    low, high = points.min(axis=0), points.max(axis=0)
    if high[0] - low[0] > 8.0 * (high[1] - low[1]):
        moved = np.hypot(*(snapshot.nodal("displacement") - snapshot.base_displacement()).T)
        centre = snapshot.position[moved > 0.25 * moved.max()][:, 0] if moved.max() > 0.0 else points[:, 0]
        middle, half = np.median(centre), 3.0 * (high[1] - low[1])
        low[0], high[0] = max(low[0], middle - half), min(high[0], middle + half)
    margin = 0.06 * (high[1] - low[1])
    return [low[0], high[0], low[1] - margin, high[1] + 2.0 * margin]
