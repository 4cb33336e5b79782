# The chain from meshes to answers, for the cases that include it. Before the include a Snakefile defines
#
#   SHAPES   name -> words of scree-mesher that make the shape, without "scree-mesher" and "-o", {} if the case needs none:
#            {"fels": "import /usr/share/assimp/models/3DS/fels.3ds", "cube": 'generate box --size "1 cm, 1 cm, 1 cm"'}
#   RUNS     name -> (file of the case, words for scree-decomposer pack): {"drum": ("case.toml", ""), ...}
#
# and, where wanted,
#
#   STATISTICS  words for scree-post statistics, for instance "--from 2 --repose slope"; or such words for each run by its name
#   PICTURE     words for scree-post picture, for instance "--colour population"
#   PLOT        the quantity of the statistics that a sweep draws, for instance "angle_of_repose"
#   PACK_INPUTS further files that the cases are made of: a list of all, or a list for each run by its name
#   BESIDE      name -> (file of the case, words, files that it begins with): runs without statistics and report, which the cases begin with
#               or are judged by
#   RANKS       of each run, where --config has none and there is no sweep; else they are chosen as below
#
# Runs go side by side, each with its share of the cores. How many of those it uses depends on its size (ranks.py): a small one runs on one rank,
# a large one on as many as it has cores. The results are the same bits on any number.
#
# Its rule all asks for everything(), or for the files of single runs, result("drum"). Words of --config (workflows/run CASE --help prints these lines; a word
# that no line of a Snakefile reads is refused, see config_words.py):
#
#   ranks=N                    of MPI, of each run (chosen by its size)
#   threads=N                  of each rank
#   minutes=N                  of the solver's job in a queue
#   statistics=WORDS           of scree-post statistics, instead of those of the case
#   sweep=KEY=VALUE|VALUE;...  runs of a grid over keys of the case, several with a semicolon: "sweep=pairs.*.friction=0.2|0.4;time.duration=1 s|2 s"
#   replicas=N                 runs of each point of the grid, with seeds 1 to N
#   plot=QUANTITY              that a sweep draws: of all bodies, of one wall (torque_y@drum), or FILE.py:FUNCTION (sweep_quantity.py)
#   points=FILE                for programs that choose the points: a JSON file of name -> {"case": a run of RUNS, key: value, ...}; statistics only
#
# Every step is a command line that also runs by hand, in the folder out/.
#
# Names of shapes, files and folders are the user's, and may hold blanks, quotes, braces or $(...): in a command everything stands as {...:q}, words
# as a list of them. Snakemake takes braces for a wildcard, in the names of inputs even where a function gives them: see watched().
import itertools
import json
import os
import re
import shlex
import sys
import packaging.version  # min_version of Snakemake 7.32 (Debian 13) needs it and does not import it
from snakemake.utils import min_version

min_version("7.0")
HERE = str(workflow.current_basedir)  # of this file, whoever includes it
sys.path.insert(0, HERE)
sys.dont_write_bytecode = True
import case_keys

RANKS = int(config.get("ranks", globals().get("RANKS", 0)))  # 0: chosen for each run
THREADS = int(config.get("threads", 1))  # of each rank

STATISTICS = config.get("statistics", globals().get("STATISTICS", ""))
PACK_INPUTS = globals().get("PACK_INPUTS", [])
BESIDE = globals().get("BESIDE", {})
SWEEP = str(config.get("sweep", ""))
REPLICAS = int(config.get("replicas", 1))


# The run at a point of its keys.
def with_keys(run, point):
    case, words = run
    return case, " ".join([words] + ["--set " + shlex.quote(f"{key}={value}") for key, value in point.items()])


# The runs at the points of a file.
def given(runs, file):
    with open(file, encoding="utf-8") as text:
        points = json.load(text)
    all_runs = {}
    for name, point in points.items():
        case = point["case"] or next(iter(runs))
        if case not in runs or (point["case"] is None and len(runs) > 1):
            raise WorkflowError(f"points: {name} is of the run {point['case'] or '(none given)'}; there are: {', '.join(runs)}")
        point["case"] = case
        all_runs[name] = with_keys(runs[case], {key: value for key, value in point.items() if key != "case"})
    return all_runs, points


# What a sweep makes of the runs: each run at each point of the grid, with seeds 1, 2, ... when there are replicas.
def swept(runs):
    try:
        axes = case_keys.axes_of(SWEEP)
    except case_keys.Wrong as reason:
        raise WorkflowError(str(reason))
    if REPLICAS > 1:
        axes.append([("seed", str(seed)) for seed in range(1, REPLICAS + 1)])
    all_runs, points = {}, {}
    for run in runs:
        for number, point in enumerate(itertools.product(*axes)):
            name = f"{run}-{number:03d}"
            all_runs[name] = with_keys(runs[run], dict(point))
            points[name] = {"case": run, **dict(point)}
    return all_runs, points


POINTS = {}
if "points" in config:
    RUNS, POINTS = given(RUNS, config["points"])
elif SWEEP.strip("; ") or REPLICAS > 1:
    RUNS, POINTS = swept(RUNS)


if POINTS and "ranks" not in config:
    RANKS = 0

PLOT = str(config.get("plot", globals().get("PLOT", "coordination_number")))
if POINTS and "points" not in config:
    import sweep_quantity
    try:
        changed = {word.partition("=")[0] for _, words in RUNS.values() for word in shlex.split(words) if "=" in word}
        sweep_quantity.check(PLOT, sorted({os.path.join(workflow.basedir, case) for case, _ in RUNS.values()}), os.environ.get("PWD", "."), changed)
    except sweep_quantity.Wrong as reason:
        raise WorkflowError(str(reason))
    if ".py:" in PLOT:   # of where workflows/run was called; the steps run in the folder of the results
        PLOT = os.path.join(os.environ.get("PWD", "."), PLOT)


# Cores of a run. They are no parameter of a rule, so that another number of cores makes nothing anew.
def cores_of_run(wildcards):
    return RANKS * THREADS if RANKS else max(THREADS, (workflow.cores or 1) // max(1, len(RUNS)))


SHAPE_FILES = [f"{shape}.shape.h5" for shape in SHAPES]


wildcard_constraints:
    shape="|".join(map(re.escape, SHAPES)) or "no_shape",
    run="|".join(map(re.escape, RUNS)),
    beside="|".join(map(re.escape, BESIDE)) or "no_run",


# The record of the run is asked for by name: Snakemake does not rebuild a missing file in the middle of a chain.
def result(run):
    return [f"{run}.run/run.json", f"{run}.run/paraview/open_in_paraview.py", f"{run}.png", f"{run}.bodies.csv",
            f"{run}.statistics/statistics.json", f"{run}.report.html"]


def everything():
    if "points" in config:
        return [f"{run}.statistics/statistics.json" for run in RUNS]
    if POINTS:
        return ["sweep.csv", "sweep_means.csv", "sweep.svg", "sweep.png"]
    return [file for run in RUNS for file in result(run)]


# The file that a shape is made from, so that it is made anew when the file changes; none for a generated one.
def mesh_of(wildcards):
    words = shlex.split(SHAPES[wildcards.shape])
    values = [word.partition("=")[2] if word.startswith("--") else word for word in words[1:]]
    return [value for value in values if words[0] != "generate" and not value.startswith("-") and os.path.isfile(value)]


# A shape has the name of its file. Of several meshes in one file, each keeps its own name, as it does where names are given.
def name_of(wildcards):
    words = shlex.split(SHAPES[wildcards.shape])
    takes_one = words[0] == "generate" or words[0] == "import" and len(mesh_of(wildcards)) < 2
    return ["--name", wildcards.shape] if takes_one and not any(word.split("=")[0] == "--name" for word in words) else []


# What a rule waits for and watches. A file with braces in its path is no input: its last change is a parameter, and makes anew what depends on it.
def watched(files):
    return [file for file in files if "{" not in file]


def changes(files):
    return [os.stat(file).st_mtime_ns for file in files if "{" in file and os.path.exists(file)]


rule shape:
    input: lambda wildcards: watched(mesh_of(wildcards))
    output: "{shape}.shape.h5"
    params:
        words=lambda wildcards: shlex.split(SHAPES[wildcards.shape]),
        changes=lambda wildcards: changes(mesh_of(wildcards)),
        name=name_of,
    shell: "scree-mesher {params.words:q} -o {output:q} {params.name:q}"


# The case names its shapes relative to itself, so it moves to where they are. One with an absolute path is read where it is.
def case_of(wildcards):
    case = RUNS[wildcards.run][0]
    return case if os.path.isabs(case) else f"{wildcards.run}.toml"


def given_case(runs, name):
    return os.path.join(workflow.basedir, runs[name][0])


rule case:
    input: lambda wildcards: watched([given_case(RUNS, wildcards.run)])
    output: "{run}.toml"
    params: case=lambda wildcards: given_case(RUNS, wildcards.run), changes=lambda wildcards: changes([given_case(RUNS, wildcards.run)])
    shell: "cp {params.case:q} {output:q}"


# A run that is made of one bed alone is not made again when another bed is.
def pack_inputs(run):
    return PACK_INPUTS[POINTS.get(run, {}).get("case", run)] if isinstance(PACK_INPUTS, dict) else PACK_INPUTS


rule pack:
    input:
        case=lambda wildcards: watched([case_of(wildcards)]),
        others=lambda wildcards: watched(pack_inputs(wildcards.run)),
        shapes=lambda wildcards: SHAPE_FILES,
    output: "{run}.scene.h5"
    params:
        case=case_of,
        words=lambda wildcards: shlex.split(RUNS[wildcards.run][1]),
        # a number that is chosen when the scene is there is unknown here: the solver then divides the scene itself, once, by the same method
        ranks=["--ranks", RANKS] if RANKS else [],
        changes=lambda wildcards: changes([case_of(wildcards), *pack_inputs(wildcards.run)]),
    shell: "scree-decomposer pack {params.case:q} -o {output:q} {params.ranks:q} {params.words:q}"


# The output is a file in the folder, never the folder, which Snakemake would remove with the checkpoints in it.
# A checkpoint that is younger than the scene belongs to it and is continued; a folder without one is begun anew.
# The lock passes to mpirun: a solver that outlives its killed workflow is never joined by a second one.
# Open MPI 4 passes SIGUSR1 on at once, SIGTERM and SIGINT only after its grace time; so mpirun gets a process group of
# its own (set -m), and the shell turns the signals that it is sent, or Ctrl-C, into SIGUSR1: the solver then writes a checkpoint. A queue
# sends SIGUSR1 itself when the time of a job runs out.
# A failed run loses its run.json to Snakemake, so the outcome is kept under another name.
rule solve:
    input: "{run}.scene.h5"
    output: "{run}.run/run.json"
    threads: cores_of_run
    # for a queue, which must know them before the scene is there
    resources: tasks=RANKS or (1 if POINTS else 2), cpus_per_task=THREADS, runtime=int(config.get("minutes", 1440))
    params:
        ranks=RANKS,
        script=lambda wildcards: os.path.join(HERE, "ranks.py"),
        threads=THREADS,  # said to each rank: Snakemake itself exports OMP_NUM_THREADS = all threads of the rule
        run="{run}.run",
        failed="{run}.failed.json",
        lock=".{run}.solver.lock",
    shell:
        """
        exec 9>{params.lock:q}
        flock --nonblock 9 || {{ echo "a solver of a run that was killed is still at work here" >&2; exit 4; }}
        restart="--restart latest"
        last=$(ls -t {params.run:q}/checkpoint_[0-9]*[0-9].h5 2>/dev/null | head -n 1 || true)
        if [ -z "$last" ] || [ "$last" -ot {input:q} ]; then restart=""; rm -rf {params.run:q}; fi
        rm -f {params.failed:q}
        ranks={params.ranks:q}
        if [ $ranks -eq 0 ]; then ranks=$(/usr/bin/python3 {params.script:q} {input:q} ${{SLURM_NTASKS:-$(( {threads} / {params.threads:q} ))}}); fi
        code=0
        set -m
        OMP_NUM_THREADS={params.threads:q} mpirun -n $ranks scree-solver {input:q} -o {params.run:q} $restart &
        trap "kill -USR1 $!" TERM INT USR1
        wait $! || code=$?
        while kill -0 $! 2>/dev/null; do code=0; wait $! || code=$?; done
        if [ $code -ne 0 ] && [ -f {params.run:q}/run.json ]; then cp {params.run:q}/run.json {params.failed:q}; fi
        exit $code
        """


# The runs that the cases begin with are killed and continued as the cases are.
rule pack_beside:
    input:
        case=lambda wildcards: watched([given_case(BESIDE, wildcards.beside)]),
        others=lambda wildcards: BESIDE[wildcards.beside][2],
        shapes=lambda wildcards: SHAPE_FILES,
    output: "{beside}.scene.h5"
    params:
        case=lambda wildcards: given_case(BESIDE, wildcards.beside),
        words=lambda wildcards: shlex.split(BESIDE[wildcards.beside][1]),
        changes=lambda wildcards: changes([given_case(BESIDE, wildcards.beside)]),
    shell: "cp {params.case:q} {wildcards.beside:q}.toml && scree-decomposer pack {wildcards.beside:q}.toml -o {output:q} {params.words:q}"


use rule solve as solve_beside with:
    input: "{beside}.scene.h5"
    output: "{beside}.run/run.json"
    params:
        ranks=RANKS,
        script=lambda wildcards: os.path.join(HERE, "ranks.py"),
        threads=THREADS,
        run="{beside}.run",
        failed="{beside}.failed.json",
        lock=".{beside}.solver.lock",


rule paraview:
    input: "{run}.run/run.json"
    output: "{run}.run/paraview/open_in_paraview.py"
    shell: "scree-post paraview {wildcards.run:q}.run"


rule bodies:
    input: "{run}.run/run.json"
    output: "{run}.bodies.csv"
    shell: "scree-post bodies {wildcards.run:q}.run -o {output:q}"


rule contacts:
    input: "{run}.run/run.json"
    output: "{run}.contacts.csv"
    shell: "scree-post contacts {wildcards.run:q}.run -o {output:q}"


# Programs that choose the points read numbers: charts would take five times as long as these.
def words_of_statistics(run):
    words = shlex.split(STATISTICS if isinstance(STATISTICS, str) else STATISTICS[POINTS.get(run, {}).get("case", run)])
    return words + ["--no-charts"] if "points" in config and "--no-charts" not in words else words


rule statistics:
    input: "{run}.run/run.json"
    output: "{run}.statistics/statistics.json"
    params: words=lambda wildcards: words_of_statistics(wildcards.run)
    shell: "scree-post statistics {wildcards.run:q}.run -o {wildcards.run:q}.statistics {params.words:q}"


# The points of the sweep are part of the command: another grid makes another table.
rule sweep:
    input: expand("{run}.statistics/statistics.json", run=POINTS)
    output: "sweep.csv", "sweep_means.csv", "sweep.svg", "sweep.png"
    params:
        points=lambda wildcards: json.dumps(POINTS),
        plot=PLOT,
        script=lambda wildcards: os.path.join(HERE, "sweep_table.py"),
    shell: "/usr/bin/python3 {params.script:q} {params.points:q} {params.plot:q} {output:q}"


rule report:
    input: "{run}.run/run.json"
    output: "{run}.report.html"
    shell: "scree-post report {wildcards.run:q}.run -o {output:q}"


rule picture:
    input: "{run}.run/run.json"
    output: "{run}.png"
    params: words=shlex.split(globals().get("PICTURE", ""))
    shell: "scree-post picture {wildcards.run:q}.run -o {output:q} {params.words:q}"
