#!/usr/bin/env python3
"""Steps a scene by the engine and prints its state hash. usage: engine_steps.py SCENE STEPS SEED

At random moments it goes back to a state that it kept, as a partner does that iterates, after it has pushed bodies about.
"""
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "post", "python"))
import scree  # noqa: E402

scene, steps, seed = sys.argv[1], int(sys.argv[2]), sys.argv[3]
random = random.Random(seed)
held = "cell" in scree.open_scene(scene).settings or (scree.open_scene(scene).settings.get("heat", {}).get("frozen", False) if scree.open_scene(scene).has_heat else False)
with scree.Engine(scene) as engine:
    while engine.steps < steps:
        window = min(steps - engine.steps, random.randint(1, max(1, steps // 3)))
        if random.random() < 0.5:
            state = engine.save()
            bodies = engine.bodies
            free = bodies.id[bodies.fixed == 0]
            if len(free) and not held:   # where forces are refused
                chosen = random.sample(list(free), min(3, len(free)))
                engine.set_wrench(chosen, [[0.1 * float(bodies.mass[0]), 0, 0]] * len(chosen))
            engine.step(min(window, 20))
            engine.restore(state)
        engine.step(window)
    print(engine.state_hash())
