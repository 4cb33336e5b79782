#!/usr/bin/env python3
"""Restitution and friction with which the throws of boxes agree best with the published ones. usage: fit.py PUBLISHED.csv FIT.json RUN...

Each run has the same throws with another pair of values. The deviance is that of two binomial samples, published and simulated, summed over the published
aspects, so that the error of the simulated throws counts as well. Tried values are compared on all aspects; and on every second aspect, from the first on,
to be judged on the others. fit.json has the deviance of every pair.
"""
import json
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from landing import deviance, landed, published, scree  # noqa: E402

if len(sys.argv) < 4:
    raise SystemExit("usage: fit.py PUBLISHED.csv FIT.json RUN...")
PUBLISHED, OUTPUT, *NAMES = sys.argv[1:]
thrown = published(PUBLISHED)
aspects = sorted(thrown)
tried = []
for name in NAMES:
    pair = scree.open(f"{name}.run").scene.pair("steel", "table")
    found = landed(name)
    rows = [deviance(*thrown[aspect], *found[aspect][:2]) for aspect in aspects]
    tried.append({"restitution": pair["restitution"], "friction": pair["friction"], "throws": sum(found[aspect][0] for aspect in aspects),
                  "not_at_rest": sum(row[2] for row in found.values()), "deviance": sum(rows), "fitted_half": sum(rows[::2]), "other_half": sum(rows[1::2])})
best, half = min(tried, key=lambda one: one["deviance"]), min(tried, key=lambda one: one["fitted_half"])
with open(OUTPUT, "w", encoding="utf-8") as file:
    json.dump({"restitution": best["restitution"], "friction": best["friction"], "fitted_on_half": half, "tried": tried}, file, indent=1)
    file.write("\n")
