"""What the scripts of this workflow share: the published throws, on which faces the boxes of a run rest, and the deviance of two sets of throws."""
import csv
import math
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402

FLAT = math.cos(math.radians(2))   # of the normal of a face against the vertical: a box that is tilted by more rests on no face
SLOW = 0.05                        # [m/s] of the centre and the surface together: a box that rocks slower stays on its face; from 0.14 on the one of 2.65 tips over


def published(path):
    """{aspect: (throws, throws that landed on a square face)}."""
    with open(path, encoding="utf-8") as file:
        try:
            rows = [(float(row["aspect"]), float(row["probability"]), int(row["throws"])) for row in csv.DictReader(file)]
        except (KeyError, TypeError, ValueError) as error:
            raise SystemExit(f"{path}: {error}: expected columns aspect, probability, throws with a number in each row") from error
    for aspect, probability, throws in rows:
        if not (aspect > 0 and abs(100 * aspect - round(100 * aspect)) < 1e-9 and 0 <= probability <= 1 and throws > 0):
            raise SystemExit(f"{path}: aspect {aspect}, probability {probability}, throws {throws}: "
                             "expected an aspect above 0 with two decimals, a probability from 0 to 1, throws above 0")
    if not rows:
        raise SystemExit(f"{path}: no rows")
    return {aspect: (throws, round(probability * throws)) for aspect, probability, throws in rows}


def name_of(aspect):
    return f"box-{100 * aspect:03.0f}"


def aspect_of(name):
    return int(name.rpartition("-")[2]) / 100


def landed(name):
    """Of a run: {aspect: (boxes at rest on a face, boxes of these on a square face, boxes in motion or on no face)} at the end."""
    run = scree.open(f"{name}.run")
    bodies = run.frames[-1].bodies
    names = bodies.shape_name.astype(str)
    reach = max(float(np.linalg.norm(run.shapes[shape].mesh.vertices, axis=1).max()) for shape in set(names))
    upright = np.abs(scree.rotation_matrix(bodies.quaternion)[:, 2, :])   # square faces are across x of the mesh
    speed = np.linalg.norm(bodies.velocity, axis=1) + reach * np.linalg.norm(bodies.angular_velocity, axis=1)
    rests = (speed < SLOW) & (upright.max(axis=1) > FLAT)
    square = rests & (upright.argmax(axis=1) == 0)
    return {aspect_of(shape): (int(rests[names == shape].sum()), int(square[names == shape].sum()), int((~rests[names == shape]).sum())) for shape in sorted(set(names))}


def deviance(n_a, k_a, n_b, k_b):
    """Twice the logarithm of the likelihood ratio of two binomial samples: with own probabilities against a common one."""
    common, value = (k_a + k_b) / (n_a + n_b), 0.0
    for n, k in ((n_a, k_a), (n_b, k_b)):
        value += sum(2 * x * math.log(x / (n * p)) for x, p in ((k, common), (n - k, 1 - common)) if x > 0)
    return value
