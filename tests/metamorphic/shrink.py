"""Makes a case that breaks a relation as small as it goes: fewer bodies, walls and keys, a shorter duration, while the violation stays."""
import copy
import time

from model import Case, used_meshes
from transforms import frozen


def shrink(case, violates, scene=None, seconds=120, say=lambda text: None):
    """in   violates   whether a case still breaks the relation   in   scene   of the case, for its populations
    Gives the smallest case found in the time."""
    end = time.time() + seconds
    attempts = 0

    def holds(candidate):
        nonlocal attempts
        if time.time() > end:
            return False
        attempts += 1
        return violates(candidate)

    if case.populations and scene is not None:
        placed = frozen(case, scene)
        if holds(placed):
            case = placed
    least = case.words["time"]["duration"] / 1000
    changed = True
    while changed and time.time() < end:
        changed = False
        for candidates in (fewer_rows, shorter, fewer_keys, plainer):
            again = True
            while again and time.time() < end:
                again = False
                for candidate in candidates(case):
                    if candidate.words["time"]["duration"] >= least and holds(candidate):
                        case, again, changed = tidy(candidate), True, True
                        break
    say(f"{attempts} attempts")
    return case


def tidy(case):
    """Without meshes that nothing names."""
    used = used_meshes(case.words)
    return Case(case.words, {name: mesh for name, mesh in case.meshes.items() if name in used}, case.note)


def fewer_rows(case):
    """Halves, quarters ... and single ones of bodies, walls and populations left out."""
    for table in ("bodies", "populations", "walls"):
        rows = case.words.get(table, [])
        size = len(rows) // 2
        while size >= 1:
            for start in range(0, len(rows), size):
                result = case.copy()
                del result.words[table][start:start + size]
                if not result.words[table]:
                    del result.words[table]
                yield result
            size //= 2
        if len(rows) == 1 and table != "bodies":
            result = case.copy()
            del result.words[table]
            yield result


def shorter(case):
    for share in (0.1, 0.25, 0.5, 0.8):
        result = case.copy()
        result.words["time"]["duration"] *= share
        if "every" in result.words.get("output", {}):
            result.words["output"]["every"] = min(result.words["output"]["every"], result.words["time"]["duration"])
        yield result


def fewer_keys(case):
    """Whole tables, then keys, wherever they are."""
    for key in list(case.words):
        if key not in ("time", "bodies", "walls", "populations", "materials", "shapes", "pairs"):
            result = case.copy()
            del result.words[key]
            yield result
    for path in paths_of(case.words, ()):
        if path == ("time", "duration"):
            continue
        result = case.copy()
        place = result.words
        for step in path[:-1]:
            place = place[step]
        del place[path[-1]]
        yield result


def paths_of(value, path):
    """Places of all keys but those of the first level, outer ones first."""
    rows = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) and value and isinstance(value[0], dict) else ()
    if path and isinstance(value, dict):
        for key in value:
            yield (*path, key)
    for key, entry in rows:
        yield from paths_of(entry, (*path, key))


def plainer(case):
    """Velocities, turns and gravity made round, one at a time."""
    def rounded(number):
        return float(f"{number:.2g}")
    for path, value in list(leaves(case.words, ())):
        new = None
        if isinstance(value, float) and rounded(value) != value:
            new = rounded(value)
        elif isinstance(value, list) and value and all(isinstance(x, float) for x in value) and path[-1] != "orientation" and [rounded(x) for x in value] != value:
            new = [rounded(x) for x in value]
        if new is not None:
            result = case.copy()
            place = result.words
            for step in path[:-1]:
                place = place[step]
            place[path[-1]] = copy.deepcopy(new)
            yield result


def leaves(value, path):
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from leaves(entry, (*path, key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for key, entry in enumerate(value):
            yield from leaves(entry, (*path, key))
    elif path:
        yield path, value
