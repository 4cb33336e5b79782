"""Relations that hold bit by bit: what must not change a result at all."""
import hashlib
import json
import math
import os
import re
import shutil
import time

import h5py
import numpy

from model import toml_value
from relations import NotApplicable, Violation, relation, require
from tools import Refused, Run, Scene, end_all, read_json

MEASURED = ("imbalance", "ghosts", "bytes_sent", "steps_per_second")   # columns of log.csv that are no physics; times too
# of run.json: what the physics is, whoever computed it
OUTCOME = ("outcome", "message", "exit_code", "steps", "step_size", "step_limited_by", "critical_step", "critical_contact", "time", "came_to_rest",
           "state_hash", "bodies", "removed_bodies", "removed_mass", "inserted_bodies", "inserted_mass", "inlets", "outlets", "lost_bodies", "bodies_outside_domain", "max_depth_ratio", "energy", "settings")


def physics_columns(log):
    return [name for name in log if name not in MEASURED and not name.startswith("t_")]


def differences(a, b):
    """What of run b is not bit by bit as in run a; no more than is needed to see where it begins."""
    found = []
    if a.code != b.code:
        found.append(f"exit {a.code} against {b.code}: {last_line(a)} | {last_line(b)}")
    # ranks agree a step later on what one of them found: of a run that became invalid the message counts, and what was before
    invalid = a.code == b.code == 5
    for key in ("outcome", "message", "exit_code") if invalid else OUTCOME:
        left, right = (a.record or {}).get(key), (b.record or {}).get(key)
        if left != right:
            found.append(f"run.json {key}: {short(left)} against {short(right)}")
    names = physics_columns(a.log)
    if names != physics_columns(b.log):
        found.append("log.csv has other columns")
    elif names:
        left, right = list(zip(*(a.log[n] for n in names))), list(zip(*(b.log[n] for n in names)))
        if len(left) != len(right) and not invalid:
            found.append(f"log.csv has {len(left)} rows against {len(right)}")
        last = invalid_step(a) if invalid else math.inf
        for l, r in zip(left, right):
            if int(l[0]) < last and l != r:
                at = [f"{n}: {x} against {y}" for n, x, y in zip(names, l, r) if x != y]
                found.append(f"log.csv at step {l[0]}: " + "; ".join(at[:4]))
                break
    if [f.number for f in a.frames] != [f.number for f in b.frames]:
        found.append(f"frames {[f.number for f in a.frames]} against {[f.number for f in b.frames]}")
    if a.series != b.series and not invalid:
        found.append("frames.hdf.series differs")
    for f, g in list(zip(a.frames, b.frames))[:-1 if invalid else None]:
        where = frame_difference(f, g)
        if where:
            found.append(f"frame {f.number}: {where}")
            break
    for name in a.tables:
        if a.tables[name] != b.tables[name] and not invalid:
            found.append(f"{name} differs: {first_difference(a.tables[name], b.tables[name])}")
    return found


def invalid_step(run):
    """The step that the message of an invalid run names, or the first."""
    words = run.record["message"].split()
    return int(words[1].rstrip(":")) if len(words) > 1 and words[0] == "step" and words[1].rstrip(":").isdigit() else 0


def frame_difference(f, g):
    for part in ("attributes", "bodies", "contacts", "walls", "loads", "impacts", "losses"):
        left, right = getattr(f, part), getattr(g, part)
        if sorted(left) != sorted(right):
            return f"{part} have other names"
        for name in left:
            if not numpy.array_equal(left[name], right[name], equal_nan=True) if part != "attributes" else left[name] != right[name]:
                return f"{part} {name}: {short(left[name])} against {short(right[name])}"
    return None


def first_difference(a, b):
    if a is None or b is None:
        return "one is missing"
    for l, r in zip(a, b):
        if l != r:
            return f"{l} against {r}"
    return f"{len(a)} lines against {len(b)}"


def short(value):
    return str(value).replace("\n", " ")[:120]


def last_line(run):
    lines = run.text.strip().splitlines()
    return lines[-1][:200] if lines else ""


def same(a, b, what):
    found = differences(a, b)
    require(not found, f"{what}: " + "\n  ".join(found[:6]))


# how the self-test breaks them

def another_hash(run):
    run.record["state_hash"] = "0" * 32


def another_last_digit(run):
    x = run.frames[-1].bodies["position"]
    x[0, 0] = numpy.nextafter(x[0, 0], numpy.inf)


def another_log_digit(run):
    run.log["kinetic_translational"][-1] += "1"


def add_a_byte(folder):
    with open(os.path.join(folder, "log.csv"), "a") as file:
        file.write("\n")


def move_a_body_in_the_last_frame(folder):
    name = sorted(name for name in os.listdir(folder) if name.startswith("frame_"))[-1]
    with h5py.File(os.path.join(folder, name), "r+") as file:
        x = file["VTKHDF/Points"][()]
        x[0, 0] += 1e-12 + 1e-12 * abs(x[0, 0])
        file["VTKHDF/Points"][...] = x


def more_steps(rows):
    rows["steps"][0] = str(int(rows["steps"][0]) + 100)


# ---- the relations

@relation("bits", another_last_digit)
def any_ranks_and_threads(trial):
    for _ in range(2):
        how = trial.parallel()
        same(trial.run, trial.solve(**how), f"{how}")


@relation("bits", another_hash)
def many_ranks(trial):
    """More ranks than bodies, too."""
    ranks = trial.random.choice([4, 5, 6, 7])
    scene, alone = trial.short()
    same(alone, trial.solve(scene, ranks=ranks), f"{ranks} ranks")


@relation("known", another_hash)
def three_ranks(trial):
    same(trial.run, trial.solve(ranks=3), "3 ranks")


@relation("bits", another_last_digit)
def any_vector_width(trial):
    width = trial.random.choice(["avx2", "sse4", "scalar"])
    same(trial.run, trial.solve(arguments=["--simd", width]), f"--simd {width}")


@relation("bits", another_log_digit)
def cut_beforehand(trial):
    """A scene that pack or partition cut is the same scene."""
    ranks, cut = trial.random.choice([2, 3]), trial.random.choice(["rcb", "rib", "hsfc", "body"])
    if trial.random.random() < 0.5 or trial.scene.count == 0:
        scene = trial.tools.pack(trial.case, "--ranks", ranks, "--cut", cut)
    else:
        path = trial.tools.new_path(".scene.h5")
        code, out, err = trial.tools.call("scree-decomposer", "partition", trial.scene.path, "--ranks", ranks, "--cut", cut, "-o", path)
        require(code == 0, f"partition ends with {code}: {err}")
        scene = Scene(path, out + err, trial.scene.case_path)
    same(trial.run, trial.solve(scene, ranks=ranks if trial.random.random() < 0.7 else 5 - ranks, arguments=["--cut", cut]), f"cut for {ranks} by {cut}")


@relation("bits", another_hash)
def packed_twice(trial):
    again = trial.tools.pack(trial.case)
    found = scene_difference(trial.scene, again)
    require(not found, f"pack makes another scene the second time: {found}")
    require(trial.seen(trial.tools.solve(again)).hash == trial.run.hash, "the same scene runs to another state")


def scene_difference(a, b, but=()):
    for part, left, right in (("bodies", a.bodies, b.bodies), ("settings", a.settings, b.settings)):
        for name in sorted(set(left) | set(right)):
            if name in but or name == "owner":
                continue
            if name not in left or name not in right:
                return f"{part} {name} is in one of them only"
            if not numpy.array_equal(left[name], right[name]) if part == "bodies" else left[name] != right[name]:
                if part == "settings" and isinstance(left[name], dict):
                    inner = [f"{key}: {short(left[name].get(key))} against {short(right[name].get(key))}"
                             for key in sorted(set(left[name]) | set(right[name])) if key not in but and left[name].get(key) != right[name].get(key)]
                    if inner:
                        return f"{name} {inner[0]}"
                    continue
                return f"{part} {name}: {short(left[name])} against {short(right[name])}"
    if len(a.shapes) != len(b.shapes):
        return f"{len(a.shapes)} shapes against {len(b.shapes)}"
    for left, right in zip(a.shapes, b.shapes):
        for name in left:
            if not numpy.array_equal(left[name], right[name]):
                return f"shape {left['name']} {name}"
    return None


@relation("bits", another_log_digit)
def killed_and_continued(trial):
    """SIGKILL at some moment, continued elsewhere, perhaps killed again: the record of one that was never killed."""
    case = with_checkpoints(trial)
    scene = trial.tools.pack(case)
    folder = trial.tools.new_path(".run")
    whole = trial.tools.solve(scene)
    moments = []
    for attempt in range(trial.random.choice([1, 1, 2])):
        how = trial.parallel()
        restart = ["--restart", "auto"] if attempt > 0 else []
        child = trial.tools.start(scene, folder, how["ranks"], how["threads"], how["arguments"] + restart)
        wait_and_kill(trial, child, folder)
        moments.append(sorted(name for name in listing(folder) if name.startswith(("checkpoint", "frame"))))
    how = trial.parallel()
    code, out, err = trial.tools.call("scree-solver", scene.path, "-o", folder, "--restart", "auto", *how["arguments"], ranks=how["ranks"], threads=how["threads"])
    require(code == whole.code, f"continued with {how}: exit {code} against {whole.code}: {err.strip()[-800:]}")
    same(whole, trial.seen(Run(folder, code, out + err, scene)), f"killed with {short(moments[-1])}, continued with {how}")


def with_checkpoints(trial):
    case = trial.case.copy()
    case.table("output")["checkpoint"] = case.words["time"]["duration"] / trial.random.randint(3, 8)
    return case


def listing(folder):
    return os.listdir(folder) if os.path.isdir(folder) else []


def wait_and_kill(trial, child, folder):
    """Kills it some time after a random one of its files appeared, or not at all when it is faster."""
    wanted, delay = trial.random.choice(["", "log", "frame_", "checkpoint_"]), trial.random.uniform(0, 0.3)
    begun = time.time()
    while child.poll() is None and time.time() < begun + 100 and not any(name.startswith(wanted) for name in listing(folder)):
        time.sleep(0.005)
    end = time.time() + delay
    while child.poll() is None and time.time() < end:
        time.sleep(0.005)
    end_all(child)
    child.wait()


@relation("bits", add_a_byte)
def restarted_when_finished(trial):
    """A run that is over stays as it is, byte by byte."""
    run = trial.completed()
    folder = trial.tools.new_path(".run")
    shutil.copytree(run.folder, folder)
    before = contents(folder)
    how = trial.parallel()
    code, out, err = trial.tools.call("scree-solver", trial.scene.path, "-o", folder, "--restart", trial.random.choice(["latest", "auto"]),
                                      *how["arguments"], ranks=how["ranks"], threads=how["threads"])
    require(code == 0, f"restart of a finished run ends with {code}: {err.strip()[-500:]}")
    if trial.spoil is not None:
        trial.spoil(folder)
    after = contents(folder)
    changed = sorted(name for name in set(before) | set(after) if before.get(name) != after.get(name))
    if "run.json" in changed:
        old, new = read_json(os.path.join(run.folder, "run.json")), read_json(os.path.join(folder, "run.json"))
        keys = [f"{key}: {short(old.get(key))} became {short(new.get(key))}" for key in sorted(set(old) | set(new)) if old.get(key) != new.get(key)]
        raise Violation("restart of a finished run changes run.json: " + "\n  ".join(keys[:8]))
    require(not changed, f"restart of a finished run changes {changed}")


def contents(folder):
    found = {}
    for name in os.listdir(folder):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = hashlib.sha256(file.read()).hexdigest()
    return found


@relation("bits", move_a_body_in_the_last_frame)
def verified(trial):
    """`verify` computes steps again on other ranks and finds the same bits."""
    run = trial.completed()
    folder = run.folder
    if trial.spoil is not None:
        folder = trial.tools.new_path(".run")
        shutil.copytree(run.folder, folder)
        trial.spoil(folder)
    how = trial.parallel()
    words = ["--from", "start"] if trial.random.random() < 0.7 else []
    if words and trial.random.random() < 0.3:
        words += ["--steps", max(1, int(run.record["steps"] * trial.random.random()))]
    code, out, err = trial.tools.call("scree-solver", "verify", folder, *words, ranks=how["ranks"], threads=how["threads"])
    if code == 2 and "nothing is recorded" in err or code == 3 and not words:
        raise NotApplicable(err.strip()[:200])
    require(code == 0 and "the same" in out and "not the same" not in out, f"verify {words} with {how}: exit {code}: {(out + err).strip()[:1500]}")


@relation("bits", another_hash)
def unneeded_things(trial):
    """A material, a shape and a pair that nothing uses."""
    case = trial.case.copy()
    if case.table("output").get("impacts"):
        raise NotApplicable("losses have a row for each pair of materials, and the state holds them")
    case.words["materials"]["unneeded"] = {"density": 1.0, "young": 1.0}
    case.words["shapes"]["unneeded"] = {"sphere": {"radius": 1e3}}
    pair = dict(case.words["pairs"][0]) if case.words.get("pairs") else {"restitution": 1.0}
    case.words.setdefault("pairs", []).append(pair | {"between": ["unneeded", sorted(case.words["materials"])[0]]})
    if trial.random.random() < 0.5:   # first in their lists
        for key in ("materials", "shapes"):
            case.words[key] = dict(sorted(case.words[key].items(), key=lambda item: item[0] != "unneeded"))
        case.words["pairs"].insert(0, case.words["pairs"].pop())
    other = trial.solve_case(case)
    require(other.hash == trial.run.hash, f"an unused material, shape and pair change the state: {trial.run.hash} against {other.hash}; "
            f"steps of {trial.run.record['step_size']!r} against {other.record['step_size']!r}")


@relation("bits", another_last_digit)
def far_away_things(trial):
    """A fixed body and a wall that nothing reaches, of materials and shapes that are there already."""
    run = trial.completed()
    case = trial.case.copy()
    if case.populations or case.words.get("inlets") or "domain" in case.words or case.value("contact", "law", "linear") == "hertz-mindlin" or "margin" not in case.table("contact"):
        raise NotApplicable("more than the far things would change")
    if not case.bodies or not any(b.get("fixed") for b in case.bodies) or not case.walls:
        raise NotApplicable("a first fixed body or wall may change the step")
    if "contact.relax" in trial.scene.text:
        raise NotApplicable("pack has separated bodies, to the rounding of the furthest place")
    size = trial.scene.size()
    still = next(b for b in case.bodies if b.get("fixed"))
    case.bodies.append(dict(still) | {"position": [1e4 * size + x for x in still["position"]]})
    other = trial.solve_case(case)
    require(other.record["step_size"] == run.record["step_size"], f"a far fixed body changes the step from {run.record['step_size']} to {other.record['step_size']}")
    for f, g in zip(run.frames, other.frames):
        for name in ("position", "quat", "velocity", "angular_velocity"):
            # bodies keep their ids, since the new one is the last of them
            require(numpy.array_equal(f.bodies[name], g.bodies[name][:-1]), f"a far fixed body changes {name} in frame {f.number}")


@relation("bits", another_hash)
def other_output(trial):
    """What is written, and how often, is no physics."""
    run = trial.completed()
    if ends_at_an_output(trial.case):
        raise NotApplicable("the run ends at an output time")
    if trial.case.value("heat", "frozen") and trial.case.value("time", "step") is None:
        raise NotApplicable("the derived step of a frozen bed is a whole part of the time between frames (CASE.md)")
    case = trial.case.copy()
    table = case.table("output")
    table["every"] = case.words["time"]["duration"] / trial.random.choice([1, 3, 17, 40])
    table["contacts"] = trial.random.random() < 0.5
    table.pop("checkpoint", None)
    if trial.random.random() < 0.5:
        table["checkpoint"] = case.words["time"]["duration"] / trial.random.randint(2, 9)
    other = trial.solve_case(case)
    require(other.code == 0, f"other output settings {table}: exit {other.code}, {last_line(other)}")
    require(other.hash == run.hash, f"other output settings {table} change the state at the end")
    where = frame_difference(without_contacts(run.frames[-1]), without_contacts(other.frames[-1]))
    require(where is None, f"other output settings {table}: last frame {where}")


# of an interval between two rows or of the rows that there are (core/storage/RUN_FORMAT.md): what depends on when rows are written
OF_INTERVALS = ("max_depth_ratio",)
OF_ROWS = ("critical_step", "critical_contact")
ENERGIES_OF_ROWS = ("error_max", "error_relative", "kinetic_peak")
OF_OUTPUT = ("output_every", "checkpoint_every", "checkpoint_by_clock")   # of the settings
kStepsBetweenFrames = 39    # at most, so that rows of the log are three steps apart at most: balls alone go four steps or more without a break
kFewFrames = 200
kStepsOfFineOutput = 12000  # of longer runs the beginning is compared


@relation("bits", another_log_digit)
def outputs_at_other_times(trial):
    """Rows of the log and frames of the same step are the same, in a run that writes after nearly every step, and in one that writes hardly
    anything. Balls alone go from one output to the next without a break (decisions/045): here single steps are compared with many."""
    if trial.case.value("heat", "frozen") and trial.case.value("time", "step") is None:
        raise NotApplicable("the derived step of a frozen bed is a whole part of the time between frames (CASE.md)")
    scene, run = trial.short(kStepsOfFineOutput)
    if run.steps == 0:
        raise NotApplicable("the run is over as it begins")
    step, duration = run.record["step_size"], scene.general["duration"]
    least = min(kStepsBetweenFrames, run.steps // kFewFrames + 1)
    for every in (step * trial.random.randint(least, kStepsBetweenFrames), duration * trial.random.choice([1, 1, 0.5, trial.random.uniform(0.1, 1.5)])):
        case = trial.case.copy()
        case.words["time"]["duration"] = duration
        case.table("output")["every"] = every
        case.table("output")["checkpoint"] = 0 if trial.random.random() < 0.7 else duration * trial.random.uniform(0.1, 0.5)
        other = trial.solve_case(case)
        found = differences_at_common_steps(case, run, other)
        require(not found, f"output every {every / step:.6g} steps: " + "\n  ".join(found[:6]))


def ends_at_an_output(case):
    return case.value("time", "stop_at_rest") or case.value("time", "stop_when_empty") or case.value("cell", "stop_when")


def differences_at_common_steps(case, a, b):
    """Of two runs that write at other times. What is in both is compared up to the step in which one of them becomes invalid."""
    found = []
    last = min([invalid_step(run) for run in (a, b) if not run.completed()], default=math.inf)
    # the energy balance is examined in rows of the log
    by_rows = any(words in run.record["message"] for run in (a, b) if not run.completed() for words in ("energy grew", "gave back"))
    if not ends_at_an_output(case) and not by_rows:
        found += outcome_difference(a, b, OUTCOME if last == math.inf else ("outcome", "message", "exit_code"))
        for name in a.tables if last == math.inf else ():
            if a.tables[name] != b.tables[name]:
                found.append(f"{name} differs: {first_difference(a.tables[name], b.tables[name])}")
    if physics_columns(a.log) != physics_columns(b.log):
        return found + ["log.csv has other columns"]
    rows, others = ({step: row for row, step in enumerate(run.log["step"])} for run in (a, b))
    common = [step for step in rows if step in others and int(step) < last]
    begin, end = 0, 0
    for step in common:
        i, j = rows[step], others[step]
        at = [f"{name}: {a.log[name][i]} against {b.log[name][j]}" for name in physics_columns(a.log)
              if name not in OF_INTERVALS and a.log[name][i] != b.log[name][j]]
        for name in OF_INTERVALS:
            left, right = max(a.column(name)[begin:i + 1]), max(b.column(name)[end:j + 1])
            if left != right:
                at.append(f"largest {name} since the common row before: {left} against {right}")
        if at:
            found.append(f"log.csv at step {step}: " + "; ".join(at[:4]))
            break
        begin, end = i + 1, j + 1
    frames = {frame.attributes["step"]: frame for frame in b.frames}
    for f in a.frames:
        g = frames.get(f.attributes["step"]) if f.attributes["step"] < last else None
        where = g and frame_difference(without_number(f), without_number(g))
        if where:
            found.append(f"frame of step {f.attributes['step']}: {where}")
            break
    return found


def outcome_difference(a, b, keys):
    """Of run.json, but for what is of the rows of the log."""
    found = []
    for key in keys:
        left, right = a.record.get(key), b.record.get(key)
        if key == "energy":
            left, right = ({name: value for name, value in energy.items() if name not in ENERGIES_OF_ROWS} for energy in (left, right))
        if key == "settings":
            left, right = ({**every, "settings": {name: value for name, value in every["settings"].items() if name not in OF_OUTPUT}}
                           for every in (left, right))
        if key not in OF_ROWS and left != right:
            found.append(f"run.json {key}: {short(left)} against {short(right)}")
    return found


def bodies_go_the_same_way(trial, case, what):
    """A case that differs in what is recorded alone."""
    other = trial.solve_case(case)
    require(other.code == trial.run.code, f"exit {other.code} against {trial.run.code}: {last_line(other)}")
    require(len(other.frames) == len(trial.run.frames), f"{len(other.frames)} frames against {len(trial.run.frames)}")
    for f, g in zip(trial.run.frames, other.frames):
        for name in f.bodies:
            require(numpy.array_equal(f.bodies[name], g.bodies[name], equal_nan=True), f"{what} changes {name} in frame {f.number}")
    for name in ("dissipated", "wall_work", "elastic", "critical_step"):
        require(trial.run.log.get(name) == other.log.get(name), f"{what} changes {name} in the log")


@relation("bits", another_last_digit)
def a_load_map_is_no_physics(trial):
    """Summing up what walls bear changes nothing of what bodies do."""
    if trial.case.value("time", "sleep"):
        raise NotApplicable("nobody sleeps on a wall with a load map")
    case = trial.case.copy()
    meshes = [wall for wall in case.walls if next(iter(wall["shape"])) not in ("plane", "box_inside", "cylinder_inside", "sphere_inside")]
    if not meshes:
        raise NotApplicable("no wall of triangles")
    if any("wear" in wall for wall in meshes):
        raise NotApplicable("a wall wears, which is physics")
    for wall in meshes:
        wall["load_map"] = not wall.get("load_map", False)
    bodies_go_the_same_way(trial, case, "a load map")


@relation("bits", another_last_digit)
def recording_impacts_is_no_physics(trial):
    """Recording impacts and losses changes nothing of what bodies do."""
    if trial.case.value("time", "sleep"):
        raise NotApplicable("is refused together with sleep")
    if "cell" in trial.case.words:
        raise NotApplicable("is refused together with a cell")
    case = trial.case.copy()
    table = case.table("output")
    table["impacts"] = not table.get("impacts", False)
    bodies_go_the_same_way(trial, case, "recording impacts")


@relation("bits", another_hash)
def stepped_by_the_engine(trial):
    """A program that steps the scene gets the state of the solver, whatever it tried and took back meanwhile."""
    run = trial.completed()
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "engine_steps.py")
    words = ["/usr/bin/python3", script, trial.scene.path, str(run.record["steps"]), f"{trial.seed} {trial.random.random()}"]
    threads = trial.random.choice([1, 1, 2])
    code, out, err = trial.tools.outcome_of(words, f"the engine with {threads} threads", threads, {"SCREE_BIN": trial.tools.bin}, None)
    require(code == 0, f"the engine ends with {code}: {err.strip()[-800:]}")
    found = trial.seen(Run(run.folder, run.code, run.text, trial.scene))
    require(out.split()[-1] == found.hash, f"the engine has the state {out.split()[-1]}, the solver {found.hash}")


def without_number(frame):
    kept = object.__new__(type(frame))
    kept.__dict__.update(frame.__dict__)
    kept.attributes = {name: value for name, value in frame.attributes.items() if name != "number"}
    return kept


def without_contacts(frame):
    kept = without_number(frame)
    kept.contacts = {}
    return kept


@relation("bits", another_last_digit)
def set_against_edited(trial):
    """--set KEY=VALUE is the file with the value in it."""
    case, changes = trial.case.copy(), []
    choices = {"time.duration": case.words["time"]["duration"] * trial.random.uniform(0.3, 0.9), "title": "another title",
               "seed": trial.random.randrange(1000), "output.contacts": trial.random.random() < 0.5}
    if case.words.get("pairs"):
        choices["pairs.*.friction"] = trial.random.uniform(0, 1)
        choices["pairs.0.restitution"] = trial.random.uniform(0.1, 1)
    if case.bodies:
        choices[f"bodies.{trial.random.randrange(len(case.bodies))}.lock_rotation"] = True
    for key in trial.random.sample(sorted(choices), 3):
        value = choices[key]
        if key == "pairs.*.friction" and any("friction_sliding" in pair for pair in case.words["pairs"]):
            continue
        set_key(case, key.split("."), value)
        changes += ["--set", f"{key}={value if isinstance(value, str) else toml_value(value)}"]
    try:
        by_set = trial.tools.pack(trial.case, *changes)
    except Refused as reason:  # with another seed a body may find no place, and then it finds none in the edited file
        try:
            trial.tools.pack(case)
        except Refused as other:
            reasons = {re.sub(r".*\.toml(:\d+)?: ", "", str(each), flags=re.S) for each in (reason, other)}
            require(len(reasons) == 1, f"{changes} is refused otherwise than the edited file: {reasons}")
            raise NotApplicable("what is set is refused, as in the edited file") from other
        raise Violation(f"{changes} is refused, the edited file is not: {reason}") from reason
    by_hand = trial.tools.pack(case)
    found = scene_difference(by_hand, by_set)
    require(not found, f"{changes} makes another scene than the edited file: {found}")
    same(trial.tools.solve(by_hand), trial.solve(by_set), f"{changes}")


def set_key(case, words, value):
    place = case.words
    for word in words[:-1]:
        if word == "*":
            for table in place:
                table[words[-1]] = value
            return
        place = place[int(word)] if word.isdigit() else place.setdefault(word, {})
    place[words[-1]] = value


@relation("bits", more_steps)
def plan_tells_what_runs(trial):
    """--plan names the step that the run takes, and as many."""
    run = trial.completed()
    code, out, err = trial.tools.call("scree-solver", trial.scene.path, "--plan")
    require(code == 0, f"--plan ends with {code}: {err[-500:]}")
    rows = {line.split()[0]: line.split()[1:] for line in out.splitlines() if line.startswith("  ") and line.split() and line.split()[0] in ("step", "steps")}
    if trial.spoil is not None:
        trial.spoil(rows)
    if "steps" not in rows:
        raise Violation(f"--plan names no number of steps:\n{out}")
    if not trial.case.value("time", "stop_at_rest") and not trial.case.value("time", "stop_when_empty") and not trial.case.value("cell", "stop_when"):
        require(abs(int(rows["steps"][0]) - run.record["steps"]) <= 1, f"--plan promises {rows['steps'][0]} steps, the run takes {run.record['steps']}")


@relation("bits", another_hash)
def the_case_in_the_scene(trial):
    """The scene keeps the case word for word: packed again from there, it is the same scene."""
    with h5py.File(trial.scene.path, "r") as file:
        record = json.loads(file["provenance"][()])
    path = os.path.join(trial.tools.new_path(".case"), "case.toml")
    os.makedirs(os.path.dirname(path))
    with open(path, "w") as file:
        file.write(record["configuration"])
    again = trial.tools.pack(trial.case, path=path)
    found = scene_difference(trial.scene, again)
    require(not found, f"the case kept in the scene makes another one: {found}")
    require(trial.seen(trial.tools.solve(again)).hash == trial.run.hash, "the case kept in the scene runs to another state")

