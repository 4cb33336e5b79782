"""What the tests of the engine share: cases, and programs that use it on ranks. usage of a test: TEST.py BIN_FOLDER MPIEXEC [TEST...]"""
import json
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.join(HERE, "..", "..", "post", "python")
sys.path[:0] = [PACKAGE, os.path.join(HERE, "..", "support")]
os.environ.update(SCREE_BIN=sys.argv[1], PYTHONPATH=PACKAGE, PYTHONDONTWRITEBYTECODE="1", OMP_NUM_THREADS="1")
sys.dont_write_bytecode = True

from tool_runs import BIN, ENV, MPIEXEC, Skipped, main, outcome, pack, run  # noqa: E402,F401

PARTNER = os.path.join(HERE, "partner.py")

GLASS = """
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = 5e3
restitution = 0.4
friction = 0.4
[shapes.ball]
sphere = { radius = "4 mm" }
"""

# balls that fall into a box, far enough to change ranks
BALLS = """
seed = 3
[time]
duration = %(duration)s
steps_per_contact = 12
%(time)s
[contact]
margin = 0
""" + GLASS + """
[[populations]]
shape = "ball"
material = "glass"
count = 80
region = { box = [["-25 mm", "-25 mm", "1 mm"], ["25 mm", "25 mm", "60 mm"]] }
velocity = [0.4, 0.3, -0.5]
[[walls]]
name = "box"
shape = { box_inside = [["-25 mm", "-25 mm", 0], ["25 mm", "25 mm", "200 mm"]] }
material = "glass"
[output]
every = %(every)s
checkpoint = %(every)s
"""

# the same with rocks, some of which sit on others from the start
PILE = """
seed = 4
[time]
duration = 0.02
steps_per_contact = 12
[contact]
margin = "0.4 mm"
""" + GLASS + """
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shapes = { ball = 1, rock = 3 }
material = "glass"
count = 24
region = { box = [["-19 mm", "-19 mm", "1 mm"], ["19 mm", "19 mm", "46 mm"]] }
velocity = [0.2, 0.1, -0.8]
[[walls]]
name = "box"
shape = { box_inside = [["-20 mm", "-20 mm", 0], ["20 mm", "20 mm", "90 mm"]] }
material = "glass"
[output]
every = 0.01
"""


def balls(duration=0.05, time="", every=0.025):
    return BALLS % {"duration": duration, "time": time, "every": every}


def pile():
    if not os.path.exists("rock.shape.h5"):
        subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "9 mm, 7 mm, 6 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                       capture_output=True)
    return PILE


def one_ball(duration=1, step="2e-5", gravity="[0, 0, 0]", position="[0.1, 0, 0]", body="", more="", time="", stiffness=1e3):
    """A ball of 1 cm, alone."""
    return f"""
gravity = {gravity}
[time]
duration = {duration}
step = {step}
{time}
[contact]
margin = 0
[materials.glass]
density = 1000
[[pairs]]
between = ["glass", "glass"]
stiffness = {stiffness}
restitution = 0.3
friction = 0.3
[shapes.ball]
sphere = {{ radius = 0.01 }}
[[bodies]]
shape = "ball"
material = "glass"
position = {position}
{body}
{more}
[output]
every = 0.1
"""


FLOOR = """
[[walls]]
name = "floor"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "glass"
"""


def needs_mpi4py():
    try:
        import mpi4py  # noqa: F401
    except ImportError:
        raise Skipped("mpi4py is not installed: apt-get install python3-mpi4py") from None


def program(name, ranks=1, threads=1, limit=600, **arguments):
    """Runs a function of partner.py as a program on ranks; what its rank 0 gives."""
    if ranks > 1:
        needs_mpi4py()
    words = [*([MPIEXEC, "-n", str(ranks)] if ranks > 1 else []), sys.executable, PARTNER, name, json.dumps(arguments)]
    result = subprocess.run(words, env=dict(ENV, OMP_NUM_THREADS=str(threads)), capture_output=True, text=True, timeout=limit)
    assert result.returncode == 0, f"{words}: exit {result.returncode}\n{result.stdout}\n{result.stderr}"
    return json.loads(result.stdout.strip().splitlines()[-1])


def solver_hash(scene, folder, *words, **options):
    """State hash at the end, and the steps, of a run of scree-solver."""
    run(1, scene, "-o", folder, *words, **options)
    end = outcome(folder)
    return end["state_hash"], end["steps"]


def refused(kind, text, action):
    try:
        action()
    except kind as error:
        assert text in str(error), f"'{text}' expected in: {error}"
        return str(error)
    raise AssertionError(f"{kind.__name__} expected, and nothing was raised; text {text}")
