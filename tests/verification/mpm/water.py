"""Still water against the soil: buoyancy, thrust, drawdown."""
import numpy as np

from runner import G, relative

WATER = 1000 * G  # N/m3


def pond_slope(r):
    """An elastic mound of 2000 kg/m3 that starts with the water's pressure all through it must swing as the same mound does in
    air under half of gravity, and have the water's pressure and that one's stress. And one of sand at 1:2 with pore water at rest stands under water."""
    scene = r.scene()
    level = scene["ponded_water"][0]["level"]
    depth = lambda x: level - x[:, 1]

    def soaked(a):
        a["effective_stress"][:, :3] = -WATER * depth(a["x"])[:, None]

    # The first swing: later on the water's pressure over the modulus, 5e-4, by which the waves of both differ, adds up.
    scene["time"]["end"] = scene["output"]["frame_interval"] = 0.05
    wet = r.run(scene, "wet", r.particles(scene, soaked)).frame()
    light = r.scene()
    light["ponded_water"] = []
    light["time"], light["output"] = scene["time"], scene["output"]
    light["gravity"] = [0, -G / 2]
    dry = r.run(light, "buoyant").frame()
    excess = wet["effective_stress"].copy()
    excess[:, :3] += WATER * depth(wet["x"])[:, None]
    error = np.abs(excess - dry["effective_stress"]).max() / (1000 * G * 4.0)

    free = r.scene()
    del free["terrain"]
    free["time"] = {"end": 1e-3, "maximum_step": 1e-4, "rest": {"stop": False}}
    free["output"]["series_interval"] = 1e-4
    first = r.run(free, "free").ledger
    lift = (first["momentum_y_Ns"][1] / 1e-4 + 2000 * G * 56.0) / (WATER * 56.0)
    aside = abs(first["momentum_x_Ns"][1]) / 1e-4 / (WATER * 56.0)

    def sand(a):
        height = np.clip(np.minimum(a["x"][:, 0], 22 - a["x"][:, 0]) / 2, 0, 4) - a["x"][:, 1]
        a["pore_pressure"][:] = WATER * depth(a["x"])
        a["effective_stress"][:] = 0
        a["effective_stress"][:, 1] = -1000 * G * np.maximum(height, 0)
        a["effective_stress"][:, [0, 2]] = 0.5 * a["effective_stress"][:, [1]]

    moved, unbalanced = [], []
    for ponds in (scene["ponded_water"], []):
        s = r.scene()
        s["ponded_water"] = ponds
        s["materials"]["soil"] = {"model": "mohr_coulomb", "density": 2000, "youngs_modulus": 2e7, "poisson_ratio": 0.3,
                                  "cohesion": 0, "friction_angle": 35}
        run = r.run(s, "sand_" + ("wet" if ponds else "without"), r.particles(s, sand))
        moved.append(run.summary["largest_displacement_m"])
        unbalanced.append(run.summary["unbalanced_force_ratio_first_step"])
    print(f"     sand at 1:2 moves {moved[0]:.4f} m under water, {moved[1]:.4f} m when the water is left out; forces out of balance at "
          f"the start: {unbalanced[0]:.3f} and {unbalanced[1]:.3f} of the weight")
    return [("stress beyond the water's pressure, over buoyant weight times height", None, None, error, 1e-3),
            ("lift over the weight of the water displaced", float(lift), 1.0, abs(lift - 1), 1e-6),
            ("force sideways over the same", None, None, float(aside), 1e-9),
            ("movement of sand at 1:2 and 35 deg under water over its height", None, None, moved[0] / 4, 0.01)]


def pond_dam(r):
    """The base's force on the dam over time, against half gamma H^2 whatever the slope of the wetted face; and the first step's
    momentum of the same dam let loose."""
    scene = r.scene()
    level = scene["ponded_water"][0]["level"]
    wanted = 0.5 * WATER * level**2
    bodies = r.run(scene).series("bodies.csv")
    late = bodies["time_s"] > 2.0
    found = float(np.mean(bodies["base_force_x_N"][late]))
    free = r.scene()
    del free["bodies"]
    free["time"] = {"end": 1e-3, "maximum_step": 1e-4, "rest": {"stop": False}}
    free["output"]["series_interval"] = 1e-4
    first = float(r.run(free, "free").ledger["momentum_x_Ns"][1] / 1e-4)
    return [("mean push on the base", found, wanted, relative(found, wanted), 0.01),
            ("thrust in the first step", first, wanted, relative(first, wanted), 1e-6)]


def pond_drawdown(r):
    """Undrained, one-dimensional: total stress falls by gamma dL, pore pressure by K / (K + M) of it."""
    scene = r.scene()
    soil = scene["materials"]["soil"]
    E, nu, K = soil["youngs_modulus"], soil["poisson_ratio"], soil["pore_stiffness"]
    M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))

    def start(a):
        y = a["x"][:, 1]
        a["pore_pressure"][:] = WATER * (15 - y)
        a["effective_stress"][:] = 0
        a["effective_stress"][:, 1] = -1000 * G * (10 - y)
        a["effective_stress"][:, [0, 2]] = nu / (1 - nu) * a["effective_stress"][:, [1]]

    run = r.run(scene, "falling", r.particles(scene, start))
    before, after = run.frame(0), run.frame(-1)
    fall = WATER * 4.0
    total = lambda f: f["effective_stress"][:, 1] - f["pore_pressure"]
    change = float(np.mean(total(after) - total(before)))
    pore = float(np.mean(after["pore_pressure"] - before["pore_pressure"]))
    still = run.frame(2)  # 1 s: the water has not moved yet, and nothing else should have
    return [("change of stress before the fall, over the stress at the base", None, None,
             float(np.abs(total(still) - total(before)).max() / (WATER * 5 + 2000 * G * 10)), 0.01),
            ("total vertical stress taken off", change, fall, relative(change, fall), 0.01),
            ("fall of the pore pressure", -pore, fall * K / (K + M), relative(-pore, fall * K / (K + M)), 0.01)]


def pond_3d(r):
    """Momentum of the first step: Archimedes in deep water; on one side half gamma H^2 per metre of width."""
    lift = r.run(r.scene(), "deep").ledger
    found = lift["momentum_y_Ns"][1] / 1e-4 + 2000 * G * 75.0
    one = r.scene()
    one["ponded_water"] = [{"name": "reservoir", "level": 4, "x_to": 2.5}]
    # Water would run around the block's ends; what presses on them on one side is balanced by the other.
    thrust = float(r.run(one, "one_side").ledger["momentum_x_Ns"][1] / 1e-4)
    wanted = 0.5 * WATER * 16 * 3
    return [("lift over the weight of the water displaced", float(found / (WATER * 75)), 1.0,
             abs(found / (WATER * 75) - 1), 1e-6),
            ("thrust of water on one side", thrust, wanted, relative(thrust, wanted), 1e-6)]
