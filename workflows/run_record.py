"""What the scripts of the workflows read of a run."""
import json
import tomllib


def record_of(run):
    """run.json of NAME.run."""
    with open(f"{run}.run/run.json", encoding="utf-8") as file:
        return json.load(file)


def case_of(record):
    """The case that the run was made from, as it was after --set."""
    return tomllib.loads(record["provenance"]["inputs"][0]["history"]["configuration"])


def si(value):
    """A number, or a length or time with its unit, in metres or seconds."""
    if not isinstance(value, str):
        return float(value)
    number, unit = value.split()
    return float(number) * {"m": 1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "s": 1, "ms": 1e-3, "us": 1e-6}[unit]
