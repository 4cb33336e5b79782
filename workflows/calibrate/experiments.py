"""Which measurement would fix the keys that the answers leave open: the experiments that have no target are run at points of the posterior, and each of
their numbers, as well as the other numbers of the runs that are there, is judged by how narrow the intervals would become if it were measured.

How: a hypothetical measurement is drawn from the posterior (the number at one of its points); the points are weighted anew by a Gaussian about that number,
with the variance of the measurement and that of the surrogate; the widths of the intervals are averaged over the draws. Source: expected reduction of
uncertainty as the utility of an experiment, Lindley, Ann. Math. Stat. 27 (1956) 986; Chaloner and Verdinelli, Stat. Sci. 10 (1995) 273, with the width
of the interval in place of the entropy.
"""
import os

import numpy as np

from posterior import Posterior
from settings import FEWEST
from surrogate import Surrogate

POINTS = 2000         # of the posterior: enough for those that a certain measurement leaves
DRAWS = 40            # hypothetical measurements
REPEATS = (1, 2, 4, 8, 16, 32)   # of the experiment
FIXED = 1 / 3         # width of an interval over that of the bounds, from which on a proposal counts as fixing the key
FINEST = 0.02         # of its value: a measurement is not thought to be more certain (standard deviation), however little the runs scatter
TWINS = 0.9999        # correlation of two numbers of the same runs from which on the second says nothing new
# what an experiment can measure, of the summaries: the easier first; of numbers that say the same the first is kept
EASY = ("mass", "discharged_mass", "discharge_rate", "angle_of_repose", "particle_count", "centre_of_mass_x", "centre_of_mass_y", "centre_of_mass_z", "solid_fraction",
        "solid_fraction_of_container", "mixing_index", "torque_x", "torque_y", "torque_z", "power", "force_x", "force_y", "force_z", "pressure")
TRACKED = ("velocity_x", "velocity_y", "velocity_z", "mean_speed", "coordination_number", "mean_spin")   # these need tracked grains, or tomography


def spread(points, count):
    """Of the points, `count` that lie far from each other: the one nearest to the mean, then always the one farthest from those chosen."""
    points = np.asarray(points)
    chosen = [int(np.argmin(((points - points.mean(axis=0)) ** 2).sum(axis=1)))]
    nearest = np.full(len(points), np.inf)
    while len(chosen) < count:
        nearest = np.minimum(nearest, ((points - points[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(np.argmax(nearest)))
    return points[chosen]


def expected_widths(points, mean, deviation):
    """Widths of the 95 % intervals of the keys, 0 to 1, if a number were measured: means over the posterior.

    in   points     N x D of equal weight
    in   mean       N, the number at each
    in   deviation  N, standard deviation of measurement and surrogate together
    out  D
    """
    widths = []
    for truth in np.linspace(0, len(points) - 1, DRAWS).astype(int):
        likelihood = -np.log(deviation) - 0.5 * ((mean - mean[truth]) / deviation) ** 2
        weights = np.exp(likelihood - likelihood.max())
        updated = Posterior(points, weights / weights.sum(), likelihood)
        widths.append([high - low for low, high in map(updated.interval, range(points.shape[1]))])
    return np.mean(widths, axis=0)


def proposal(points, surrogate, stop, now):
    """What a measurement of a surrogate's number would bring.

    in   points  N x D of equal weight
    in   stop    the surrogate is to be known to this fraction of the measurement
    in   now     D, the widths of the intervals
    out  change over the posterior and scatter of one run; repeats of the experiment and widths then, and the runs from which on the surrogate adds nothing to them
    The widths are those with the runs that are there: further runs may as well show that a number does not depend on the keys. The repeats are the fewest that fix a key that is open now; without such, those of the
    narrowest intervals.
    """
    mean, unsure = surrogate.predict(points)
    finest = FINEST * float(np.abs(np.median(mean)))
    best = None
    for repeats in REPEATS:
        deviation = max(surrogate.noise / np.sqrt(repeats), finest)
        widths = np.minimum(expected_widths(points, mean, np.hypot(deviation, unsure)), now)
        worst = float(np.sqrt(np.mean(unsure**2))) / (stop * deviation) if stop > 0 else 1.0
        entry = {"repeats": repeats, "runs": int(np.ceil(len(surrogate.answers) * max(1.0, worst**2))), "widths": [float(width) for width in widths], "deviation": float(deviation)}
        fixes = [bool(before > FIXED >= after) for before, after in zip(now, widths)]
        if best is None or sum(fixes) > sum(best["fixes"]) or (not any(fixes) and min(widths / now) < 0.9 * min(np.array(best["widths"]) / now)):
            best = {**entry, "fixes": fixes}
        if deviation <= finest:   # further repeats change nothing
            break
    return {"change": float(mean.std()), "scatter": surrogate.noise, **best}


def numbers_of(runs, summaries, scene, targets, folder_of):
    """Numbers of a scene's runs that can be measured: (group, quantity), unit, places, values. Constants, targets and what says the same as they do are left out."""
    rows = [(run["place"], summaries.of(scene, name)) for name, run in runs.of([scene]).items()
            if "failed" not in run and os.path.exists(os.path.join(folder_of(scene, name), "statistics.json"))]
    found = []
    if len(rows) < FEWEST:
        return found
    easier_first = {quantity: place for place, quantity in enumerate(EASY + TRACKED)}
    for group, quantity in sorted((name for name in rows[0][1] if name[1] in easier_first), key=lambda name: (name not in targets, easier_first[name[1]])):
        values = [row.get((group, quantity), {}).get("mean") for _, row in rows]
        if not all(values):
            continue
        y = np.array(values, float)
        if not np.all(np.isfinite(y)) or y.std() <= 1e-9 * np.abs(y).max():
            continue
        if any(abs(np.corrcoef(y, other)[0, 1]) > TWINS for _, _, _, other in found):
            continue
        found.append(((group, quantity), rows[0][1][group, quantity]["unit"], np.array([place for place, _ in rows]), y))
    return [entry for entry in found if entry[0] not in targets]


def proposals(settings, runs, summaries, found, folder_of):
    """Of all numbers, what a measurement of each would bring: those first that fix most keys, and of these those that are easy to measure.

    Cost: a surrogate for each number, 0.1 to 0.3 s.
    """
    points = found.even(POINTS)
    now = np.array([high - low for low, high in map(found.interval, range(len(settings.keys)))])
    entries = []
    for scene in [*settings.scenes, *settings.experiments]:
        targets = {(target.group, target.quantity) for target in settings.targets if target.scene == scene}
        for (group, quantity), unit, places, values in numbers_of(runs, summaries, scene, targets, folder_of):
            entries.append({"number": f"{scene.name}:{quantity}" + (f"@{group}" if group != "all" else ""), "unit": unit, "runs_there": len(values), "tracked": quantity in TRACKED,
                            **proposal(points, Surrogate(places, values), settings.stop, now)})
    return sorted(entries, key=lambda entry: (not any(entry["fixes"]), entry["tracked"], -sum(entry["fixes"]), entry["repeats"] if any(entry["fixes"]) else 0,
                                              float(np.prod(np.array(entry["widths"]) / now))))
