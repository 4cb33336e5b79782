"""What the scripts of the workflows read of a run."""
import json
import tomllib

import h5py


def record_of(run):
    """run.json of NAME.run."""
    with open(f"{run}.run/run.json", encoding="utf-8") as file:
        return json.load(file)


def case_of(record):
    """The case that the run was made from, as it was after --set."""
    return tomllib.loads(record["provenance"]["inputs"][0]["history"]["configuration"])


def frame_at(run, time=None):
    """Positions N x 3 [m] in the last frame, or in the last one at or before a time."""
    with open(f"{run}.run/frames.hdf.series", encoding="utf-8") as file:
        entries = [entry for entry in json.load(file)["files"] if time is None or entry["time"] <= time * (1 + 1e-9)]
    with h5py.File(f"{run}.run/{entries[-1]['name']}", "r") as file:
        return file["VTKHDF/Points"][:]


def si(value):
    """A number, or a length or time with its unit, in metres or seconds."""
    if not isinstance(value, str):
        return float(value)
    number, unit = value.split()
    return float(number) * {"m": 1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "s": 1, "ms": 1e-3, "us": 1e-6}[unit]
