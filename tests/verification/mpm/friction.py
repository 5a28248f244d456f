"""Blocks on Coulomb friction."""
import math

import numpy as np

from runner import G, relative


def mu_block(r):
    run = r.run()
    travelled = run.front["centre_x_m"][-1] - run.front["centre_x_m"][0]
    wanted = 5.0**2 / (2 * 0.35 * G)
    return [("distance, m", travelled, wanted, relative(travelled, wanted), 0.01)]


def incline(r):
    rows = []
    for mu in (0.35, 0.6):
        for angle in (0, 5, 10, 15, 20, 25, 30, 35, 40, 45):
            beta = math.radians(angle)
            c, s = math.cos(beta), math.sin(beta)
            scene = r.scene()
            scene["particles"][0]["rotation"] = -angle
            scene["particles"][0]["stress"].update(surface_point=[s, c], angle=angle, shear_ratio=min(mu, s / c))
            scene["terrain"][0].update(points=[[-100 * c, 100 * s], [100 * c, -100 * s]], friction=mu)
            run = r.run(scene, f"mu{mu}_{angle}")
            t = run.front["time_s"]
            along = run.front["centre_x_m"] * c - run.front["centre_y_m"] * s
            wanted = max(0.0, G * (s - mu * c))
            late = t >= 0.3
            found = 2.0 * np.polyfit(t[late], along[late], 2)[0]
            if wanted > 0.0:
                rows.append((f"acceleration, mu {mu}, {angle} deg", found, wanted, relative(found, wanted), 0.01))
            else:
                drift = abs(along[-1] - along[t >= 0.3][0])
                rows.append((f"drift in cells when sticking, mu {mu}, {angle} deg", None, None, drift / 0.25, 0.001))
    return rows


def clay_slab(r):
    """A slab of phi = 0 soil, 1 m thick, in motion: ground that could hold more takes its strength c per area, g sin b - c
    / (rho H); ground that holds less takes its friction. The ceiling is this test's own."""
    rows = []
    for mu, angle in ((2.0, 0), (2.0, 15), (2.0, 30), (2.0, 45), (0.2, 0)):
        beta = math.radians(angle)
        c, s = math.cos(beta), math.sin(beta)
        held = min(8000 / 2000, mu * G * c)
        scene = r.scene()
        scene["particles"][0].update(rotation=-angle, velocity=[3, 0])
        scene["particles"][0]["stress"].update(surface_point=[s, c], angle=angle, shear_ratio=held / (G * c))
        scene["terrain"][0].update(points=[[-100 * c, 100 * s], [100 * c, -100 * s]], friction=mu)
        run = r.run(scene, f"mu{mu}_{angle}")
        t = run.front["time_s"]
        found = 2.0 * np.polyfit(t, run.front["centre_x_m"] * c - run.front["centre_y_m"] * s, 2)[0]
        wanted = G * s - held
        rows.append((f"acceleration, c / (rho g H) 0.41, mu {mu}, {angle} deg", found, wanted, abs(found - wanted) / held, 0.02))
    return rows


def centre(frame):
    return np.average(frame["x"], axis=0, weights=frame["mass"])


def incline_3d(r):
    """A block on a plane, sliding along a diagonal under tilted gravity; one on a slope turned against the grid, sliding
    down it and sticking; all with mu = 0.35."""
    rows, mu = [], 0.35
    beta = math.radians(30)
    c, s = math.cos(beta), math.sin(beta)

    scene = r.scene()
    scene["gravity"] = [G * s * math.cos(0.6), -G * c, G * s * math.sin(0.6)]
    run = r.run(scene, "diagonal")
    rows.append(diagonal_row(run, G * (s - mu * c)))

    for angle in (10, 30):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        scene = r.scene()
        scene["terrain"][0]["points"] = [[-100 * c, 100 * s], [100 * c, -100 * s]]

        def turned(p, c=c, s=s):
            x, y = p["x"][:, 0].copy(), p["x"][:, 1].copy()
            p["x"][:, 0], p["x"][:, 1] = c * x + s * y, -s * x + c * y
            # Infinite slope with the shear that friction allows: normal, along and across the slope, turned into the axes.
            normal = -2000.0 * G * c * (1.0 - y)
            along, shear = 0.42857 * normal, -min(mu, s / c) * normal
            stress = p["effective_stress"]
            stress[:, 0] = along * c * c + normal * s * s + 2.0 * shear * c * s
            stress[:, 1] = along * s * s + normal * c * c - 2.0 * shear * c * s
            stress[:, 2] = along
            stress[:, 3] = (normal - along) * c * s + shear * (c * c - s * s)

        run = r.run(scene, f"slope{angle}", r.particles(scene, turned))
        t = run.front["time_s"]
        along = run.front["centre_x_m"] * c - run.front["centre_y_m"] * s
        wanted = max(0.0, G * (s - mu * c))
        if wanted > 0.0:
            found = 2.0 * np.polyfit(t[t >= 0.2], along[t >= 0.2], 2)[0]
            rows.append((f"acceleration down a slope of {angle} deg", found, wanted, relative(found, wanted), 0.01))
        else:
            drift = abs(along[-1] - along[t >= 0.2][0]) / 0.25
            rows.append((f"drift in cells when sticking at {angle} deg", None, None, drift, 0.001))
    return rows


def diagonal_row(run, wanted):
    """Acceleration along the diagonal from the frames' centres of mass."""
    frames = [run.frame(k) for k in range(len(run.frames()))]
    t = np.array([f["time"] for f in frames])
    moved = np.array([centre(f) for f in frames]) - centre(frames[0])
    along = moved[:, 0] * math.cos(0.6) + moved[:, 2] * math.sin(0.6)
    late = t >= 0.2
    found = 2.0 * np.polyfit(t[late], along[late], 2)[0]
    return ("acceleration along a diagonal of the grid", found, wanted, relative(found, wanted), 0.01)
