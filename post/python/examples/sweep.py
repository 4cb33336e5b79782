#!/usr/bin/env python3
"""A sweep: one case with several values of a key, a number of each run, a table of all. Runs that are there already are not repeated.
usage: sweep.py CASE.toml FOLDER KEY=VALUE,VALUE...      for instance: sweep.py bed.toml out pairs.*.friction=0.1,0.5"""
import os
import sys

import scree

path, folder = sys.argv[1:3]
key, values = sys.argv[3].split("=")
case = scree.Case(path)
os.makedirs(folder, exist_ok=True)
rows = []
for value in values.split(","):
    name = os.path.join(folder, f"{key.replace('*', 'all')}={value}")
    try:
        run = scree.open(name + ".run")
        if run.outcome is None:
            run = scree.solve(name + ".scene.h5", name + ".run", restart="auto", threads=1, progress=False)
    except scree.InputError:  # not there yet
        part = case.copy()
        try:
            part[key] = float(value)
            run = scree.solve(scree.pack(part, name + ".scene.h5", progress=False), name + ".run", threads=1, progress=False)
        except scree.UnknownName as error:
            sys.exit(f"sweep.py: {error}")
        except scree.RunInvalid as error:  # the others of the sweep go on
            print(f"{name}: {error}", file=sys.stderr)
            continue
        except scree.Interrupted as error:
            sys.exit(f"sweep.py: {error}; call it again to go on")
        except (scree.MachineError, scree.InternalError) as error:
            sys.exit(f"sweep.py: exit code {error.exit_code} of {' '.join(error.command)}\n{error.output}")
        except scree.ScreeError as error:  # the case is wrong, or a file that it names
            sys.exit(f"sweep.py: {error}")
    numbers = run.frames[-1].measures()
    rows.append((float(value), numbers["coordination_number"], numbers["centre_of_mass_z"], numbers["kinetic_energy"]))
table = scree.Table(dict(zip((key, "coordination_number", "centre_of_mass_z", "kinetic_energy"), zip(*rows))), {"centre_of_mass_z": "m", "kinetic_energy": "J"})
print("wrote", table.write(os.path.join(folder, "sweep.csv")))
