"""Soil that yields: the return itself, collapse loads, cohesive flow."""
import math

import numpy as np

from elastic import point_checks
from runner import G, relative


def mohr_coulomb_point(r):
    return point_checks(r, "mohr_coulomb_point")


def strip_footing(r):
    """The plateau of the push on half of the footing over c B / 2 against 2 + pi (Prandtl 1920)."""
    run = r.run()
    scene = r.scene()
    body, cohesion = scene["bodies"][0], scene["materials"]["soil"]["cohesion"]
    half = body["high"][0]
    history = run.series("bodies.csv")
    depth = -history["footing_displacement_y_m"]
    factor = history["footing_force_y_N"] / (half * cohesion)
    for d, n in list(zip(depth[1:], factor[1:]))[::4]:
        print(f"     settlement {d / (2 * half):.4f} B: resistance {n:.3f} c")
    late = depth > 0.6 * depth[-1]
    found = float(np.mean(factor[late]))
    return [("bearing pressure over c", found, 2 + math.pi, abs(found / (2 + math.pi) - 1), 0.03),
            ("its growth over the last third of the settlement", None, None,
             abs(np.polyfit(depth[late], factor[late], 1)[0] * np.ptp(depth[late]) / found), 0.03)]


def vertical_cut(r):
    """Where the crest goes from standing to falling, against 3.83 (Taylor 1937), with local damping and without. Standing, it
    settles by less than 0.5 % of the height (without damping it rings); a cut 5 % too high stands again once it has lost about 5 %, so
    more than 2 % counts as a fall."""
    rows = []
    for damped in (True, False):
        standing = []
        for number in (3.6385, 3.83, 4.0215):
            scene = r.scene()
            scene["materials"]["soil"]["cohesion"] = 2000 * G * 5.0 / number
            if not damped:
                del scene["damping"]
            run = r.run(scene, f"number{number}" + ("" if damped else "_undamped"))
            crest = run.front["crest_y_m"]
            t = run.front["time_s"]
            late = t > 0.75 * t[-1]
            rate = (crest[late][0] - crest[-1]) / (t[-1] - t[late][0])
            print(f"     gamma H / c = {number}{'' if damped else ', no damping'}: crest {(crest[0] - crest[-1]) / 5.0:.4f} H lower,"
                  f" still {rate / 5.0:.2e} H per s")
            standing.append((number, (crest[0] - crest[-1]) / 5.0 < 0.02))
        stood = max((n for n, s in standing if s), default=0.0)
        fell = min((n for n, s in standing if not s), default=math.inf)
        found = 0.5 * (stood + fell) if stood > 0.0 and math.isfinite(fell) else math.nan
        error = abs(found / 3.83 - 1)
        rows.append((f"stability number gamma H / c between standing and falling{'' if damped else ', no damping'}", found, 3.83,
                     error if math.isfinite(error) else 1.0, 0.05))
    return rows


def mean_stress_noise(frame, h):
    """RMS difference of a full cell's mean stress from the mean of its two neighbours, over the mean of all."""
    s, v = frame["effective_stress"], frame["volume"]
    mean = -(s[:, 0] + s[:, 1] + s[:, 2]) / 3.0
    cells = {}
    for p, key in enumerate(map(tuple, np.floor(frame["x"][:, :2] / h).astype(int))):
        c = cells.setdefault(key, [0.0, 0.0])
        c[0] += mean[p] * v[p]
        c[1] += v[p]
    value = {k: c[0] / c[1] for k, c in cells.items() if c[1] > 0.7 * h * h}
    d = [q - 0.5 * (value[i + a, j + b] + value[i - a, j - b]) for (i, j), q in value.items()
         for a, b in ((1, 0), (0, 1)) if (i + a, j + b) in value and (i - a, j - b) in value]
    return math.sqrt(np.mean(np.square(d))) / np.mean(list(value.values()))


def front_moved(run):
    """m, how far the front of all soil has gone."""
    return run.front["robust_front_m"][-1] - run.front["robust_front_m"][0]


def cohesive_block(r):
    rows, runout = [], []
    for courant in (0.1, 0.4, 0.8):
        scene = r.scene()
        scene["time"]["courant"] = courant
        run = r.run(scene, f"courant{courant}")
        runout.append(front_moved(run))
        total = run.ledger["kinetic_J"] + run.ledger["elastic_J"] + run.ledger["gravitational_J"]
        rows.append((f"energy above the start's, courant {courant}", None, None, (total.max() - total[0]) / total[0], 1e-3))
    spread = (max(runout) - min(runout)) / np.mean(runout)
    rows.append(("spread of the runout over time steps", None, None, spread, 0.03))
    sizes = (2.0, 1.0, 0.5, 0.25)
    by_cell = []
    for cell in sizes:
        scene = r.scene()
        scene["grid"]["cell_size"] = cell
        by_cell.append(front_moved(r.run(scene, f"cell{cell:g}")))
    print("     runout with cells of " + ", ".join(f"{h:g} m: {x:.2f} m" for h, x in zip(sizes, by_cell)))
    finer = by_cell[1:]  # the ceiling is this test's own: the one for the time step
    rows.append((f"spread of the runout over cells of 1, 0.5 and 0.25 m ({by_cell[0]:.1f} m with 2 m)", finer[0], finer[-1],
                 (max(finer) - min(finer)) / np.mean(finer), 0.03))
    noise = {}
    for average in (True, False):
        scene = r.scene()
        scene["scheme"] = {"volumetric_average": average}
        scene["materials"]["soil"]["poisson_ratio"] = 0.49
        scene["particles"][0]["stress"]["k0"] = 0.49 / 0.51
        run = r.run(scene, f"nu049_{'averaged' if average else 'plain'}")
        noise[average] = mean_stress_noise(run.frame(), 0.5)
    rows.append(("checkerboard at rest, averaged over plain", noise[True], noise[False], noise[True] / noise[False], 0.1))
    rows.append(("RMS difference of neighbouring cells' mean stress over the mean", None, None, noise[True], 0.05))
    return rows


def bingham_start(thickness, angle, density, yield_stress, viscosity, shear_modulus, times, layers=120):
    """Surface speed (m/s) of a Bingham slab without end that is let go, at `times` (s): layers that carry shear stress,
    elastic up to the yield stress and viscous beyond, each step explicit in motion and implicit in flow."""
    dy = thickness / layers
    dt = 0.4 * dy * (density / shear_modulus) ** 0.5
    depth = thickness - dy * np.arange(layers)  # of the layers' lower faces, the ground's first
    stress = np.minimum(density * G * np.sin(angle) * depth, yield_stress)
    speed, found, t = np.zeros(layers), [], 0.0
    for end in times:
        while t < end:
            rate = np.diff(speed, prepend=0.0) / dy
            stress += shear_modulus * dt * rate
            over = np.maximum(np.abs(stress) - yield_stress, 0.0)
            stress -= np.sign(stress) * shear_modulus * dt * over / (shear_modulus * dt + viscosity)
            speed += dt * (G * np.sin(angle) + np.diff(stress, append=0.0) / dy / density)
            t += dt
        found.append(speed[-1])
    return np.array(found)


def bingham_slab(r):
    rows = []
    for degrees, cells in [(5, 10), (12, 6), (12, 10), (12, 15), (20, 10)]:
        scene, angle = r.scene(), np.radians(degrees)
        mud = scene["materials"]["mud"]
        thickness = 1.5 * mud["cohesion"] / (mud["density"] * G * np.sin(angle))
        # As stiff beside its weight as the scene's own: what a softer one is relieved of at its ends reaches the middle.
        mud["youngs_modulus"] *= max(1.0, thickness / scene["particles"][0]["high"][1])
        scene["grid"]["cell_size"] = thickness / cells
        box = scene["particles"][0]
        box.update(high=[160 / 3 * thickness, thickness], rotation=-degrees)
        box["stress"].update(angle=degrees, surface_point=[thickness * np.sin(angle), thickness * np.cos(angle)])
        scene["terrain"][0]["points"] = [[-1e3 * np.cos(angle), 1e3 * np.sin(angle)], [1e3 * np.cos(angle), -1e3 * np.sin(angle)]]
        run = r.run(scene, f"{degrees}_{cells}")
        shear_modulus = mud["youngs_modulus"] / (2 + 2 * mud["poisson_ratio"])
        wanted = bingham_start(thickness, angle, mud["density"], mud["cohesion"], mud["rate"]["consistency"], shear_modulus, [1, 2, 3, 4])
        tops = []
        for k in range(5):
            frame = run.frame(k)
            x, y, v = frame["x"][:, 0], frame["x"][:, 1], frame["velocity"]
            along, height = x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)
            middle = (along > 18 * thickness) & (along < 31 * thickness)
            tops.append(np.quantile(height[middle], 0.98))
            if k == 0:
                continue
            top = middle & (height > 0.75 * tops[-1])
            found = np.mean(v[top, 0] * np.cos(angle) - v[top, 1] * np.sin(angle))
            rows.append((f"surface speed after {k} s, m/s, {degrees} deg, {cells} cells", found, wanted[k - 1], relative(found, wanted[k - 1]), 0.05))
        rows.append((f"change of the thickness in 4 s, {degrees} deg, {cells} cells", None, None, abs(tops[-1] / tops[0] - 1), 0.03))
    return rows


def bingham_drain(r):
    """A slab of 2.5 times the thickness that stands, let go on a slope askew to the grid with both ends open: what is
    left when it has come to a stand, in its middle half, over that thickness, which is tau_y / (rho g sin b)."""
    rows = []
    for degrees, cells, end in [(12, 5, 24.0), (12, 10, 18.0), (5, 10, 40.0)]:
        scene, angle = r.scene(), math.radians(degrees)
        mud, box = scene["materials"]["mud"], scene["particles"][0]
        standing = mud["cohesion"] / (mud["density"] * G * math.sin(angle))
        mud["youngs_modulus"] *= max(1.0, 2.5 * standing / box["high"][1])
        thickness, length = 2.5 * standing, 40.0 * standing
        scene["grid"]["cell_size"] = standing / cells
        scene["time"]["end"] = scene["output"]["frame_interval"] = end
        box.update(high=[length, thickness], rotation=-degrees)
        box["stress"].update(angle=degrees, surface_point=[thickness * math.sin(angle), thickness * math.cos(angle)])
        scene["terrain"][0]["points"] = [[-1e3 * math.cos(angle), 1e3 * math.sin(angle)], [1e3 * math.cos(angle), -1e3 * math.sin(angle)]]
        frame = r.run(scene, f"{degrees}_{cells}").frame()
        along = frame["x"][:, 0] * math.cos(angle) - frame["x"][:, 1] * math.sin(angle)
        for share in (0.25, 0.5, 0.75):
            here = np.abs(along - share * length) < 3.0 * standing
            left = frame["mass"][here].sum() / mud["density"] / (6.0 * standing)
            speed = np.linalg.norm(frame["velocity"][here], axis=1).max()
            print(f"     {degrees} deg, {cells} cells to the thickness that stands: {left / standing:.3f} of it left at {share} of the length"
                  f" after {end:.0f} s, at most {speed:.3f} m/s")
            rows.append((f"thickness left over what stands, {degrees} deg, {cells} cells, at {share} of the length", left / standing, 1.0,
                         abs(left / standing - 1.0), 0.05))
    return rows


def bingham_rest(r):
    run = r.run()
    volume, tau = 0.1, 20.0
    wanted = (1.5 * volume) ** (2 / 3) * (1000 * G / (2 * tau)) ** (1 / 3)
    found = run.summary["front_position_m"]
    return [("half length at rest, m", found, wanted, abs(found / wanted - 1), 0.05)]
