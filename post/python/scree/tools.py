"""Calls of the tools, with progress passed on and errors as exceptions.

The tools are those of the folder in the environment variable SCREE_BIN, else of the PATH, else of the same installation or checkout.
"""
from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

from .case import Case
from .errors import UsageError, error_of
from .run import Run, Statistics
from .scene import Scene, Shapes, open_shapes
from .toml_text import plain, value_text

Path = Union[str, "os.PathLike[str]"]
_PROGRESS = re.compile(r"^([\w ][^:]*):\s+(\d+) %\s*(.*)$")


@dataclass(frozen=True)
class Progress:
    """How far a tool is: what a progress function is called with."""

    name: str  #: of the work, "solver"
    share: float  #: done, from 0 to 1
    text: str  #: the rest of the line: time, energies, time left


@dataclass(frozen=True)
class Result:
    """What a call of a tool left."""

    command: tuple[str, ...]  #: its words
    output: str  #: stdout: tables and verdicts
    messages: str  #: stderr: notes and progress


def _tool_path(tool: str) -> str:
    name = tool if tool.startswith("scree-") else f"scree-{tool}"
    folder = os.environ.get("SCREE_BIN")
    here = os.path.dirname(os.path.abspath(__file__))
    if folder:
        found = shutil.which(name, path=folder)
    else:
        beside = [os.path.join(here, "..", "..", "..", "..", "bin"), os.path.join(here, "..", "..", "..", "build", "release", "bin")]
        found = shutil.which(name) or shutil.which(name, path=os.pathsep.join(beside))
    if found is None:
        raise UsageError(f"{name}: not found {f'in SCREE_BIN={folder}' if folder else 'on the PATH'}; set SCREE_BIN to the folder of the tools")
    return found


def _words(options: Mapping[str, Any]) -> list[str]:
    words: list[str] = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        value = list(value) if isinstance(value, range) else value
        if value is None or value is False:
            continue
        for one in value if isinstance(value, list) else [value]:
            parts = one if isinstance(one, tuple) else [one]
            words += [flag] if one is True else [flag, *(str(plain(part)) for part in parts)]
    return words


def _message(errors: str, tool: str) -> str:
    """The error among the messages of a tool, which may span lines: all from the last "scree-X: error:" on."""
    found = list(re.finditer(rf"^{tool}: (?:internal )?error: ", errors, flags=re.M))
    if found:
        rest = errors[found[-1].end() :].splitlines()
        own = [line for line in rest[1:] if line.startswith((" ", "\t"))]
        return "\n".join([*rest[:1], *own]).strip()
    said = [line for line in errors.splitlines() if line.strip(" -") and not _PROGRESS.match(line)]
    return "\n".join(said[-20:])  # of mpirun, or of the system


def call(tool: str, *words: Any, progress: bool | Callable[[Progress], None] = True, ranks: int = 1, threads: int | None = None,
         mpirun: Sequence[str] = ("mpirun",), **options: Any) -> Result:
    """Calls a tool with any command: `scree.call("mesher", "check", "rock.stl", unit="mm")`.

    tool      "mesher", "decomposer", "solver" or "post"
    words     command and files, as on the command line
    options   of the tool: `by_material=True` is --by-material, `set=["a=1", "b=2"]` repeats --set, `size=(640, 480)` gives one option
              two words, `from_=2` is --from; None and False leave an option out
    progress  True: what the tool writes to stderr goes to sys.stderr as it comes. A function: it is called with a Progress for each
              line of progress, and other messages go to sys.stderr. False: nothing is shown
    ranks     MPI ranks; more than one are started with `mpirun -n`
    threads   of each rank; None: what the environment says

    Returns a Result. Raises a ScreeError by the exit code: UsageError 2, InputError 3, MachineError 4, RunInvalid 5, Interrupted
    128 + n, InternalError 1. A KeyboardInterrupt is passed to the tool, which ends cleanly (the solver with a checkpoint), and raised again.
    """
    path = _tool_path(tool)
    command = [path, *(str(plain(word)) for word in words), *_words(options)]
    if ranks > 1:
        command = [*mpirun, "-n", str(ranks), *command]
    environment = dict(os.environ)
    if threads is not None:
        environment["OMP_NUM_THREADS"] = str(threads)
    try:
        # a session of its own, so that Ctrl-C reaches the tool once, from here
        process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, encoding="utf-8", errors="replace", start_new_session=True)
    except OSError as error:
        raise error_of(4, f"{command[0]}: cannot be started: {error.strerror}", command, "") from error
    output: list[str] = []
    assert process.stdout is not None and process.stderr is not None
    reader = threading.Thread(target=lambda: output.append(process.stdout.read()), daemon=True)  # type: ignore[union-attr]
    reader.start()
    errors: list[str] = []
    try:
        for line in process.stderr:
            errors.append(line)
            _pass_on(line, progress)
        process.wait()
    except BaseException:
        process.send_signal(signal.SIGINT)
        errors += process.stderr.readlines()
        process.wait()
        raise
    finally:
        reader.join()
        process.stdout.close()
        process.stderr.close()
    text = "".join(errors)
    code = process.returncode if process.returncode >= 0 else 128 - process.returncode
    if code != 0:
        raise error_of(code, _message(text, os.path.basename(path)), command, text)
    return Result(tuple(command), output[0], text)


def _pass_on(line: str, progress: bool | Callable[[Progress], None]) -> None:
    if progress is False:
        return
    match = _PROGRESS.match(line)
    if callable(progress) and match:
        progress(Progress(match[1].strip(), int(match[2]) / 100, match[3].strip()))
    else:
        sys.stderr.write(line)
        sys.stderr.flush()


def _stem(path: Path, ending: str) -> str:
    return os.fspath(path).removesuffix(ending)


def import_mesh(files: Path | Sequence[Path], output: Path, **options: Any) -> Shapes:
    """Imports mesh files into one shape file with `scree-mesher import`; returns its shapes.

    files    one or a list: STL, OBJ, PLY, STEP ... (mesher/README.md)
    output   NAME.shape.h5
    options  as of `call`: `unit="mm"`, `surface=True` for a wall, `name=[...]`
    """
    paths = list(files) if isinstance(files, (list, tuple)) else [files]
    call("mesher", "import", *paths, output=output, **options)
    return open_shapes(output)


def generate(shape: str, output: Path, **options: Any) -> Shapes:
    """Generates a shape with `scree-mesher generate`; returns the shapes of the file.

    shape    "sphere", "box", "cylinder", "rock" ...; output: NAME.shape.h5
    options  as of `call`: `radius="5 mm"`, `analytic=True`, `size="1 cm, 2 cm, 3 cm"`
    """
    call("mesher", "generate", shape, output=output, **options)
    return open_shapes(output)


def pack(case: Path | Case, output: Path, set: Mapping[str, Any] | None = None, **options: Any) -> Scene:  # noqa: A002  as --set
    """Places all bodies of a case with `scree-decomposer pack`; returns the scene.

    case     a file; or a Case, which is saved beside the scene first, as NAME.toml of NAME.scene.h5
    output   NAME.scene.h5
    set      keys of the case to change, {"pairs.*.friction": 0.4}
    options  as of `call`: `ranks=2` cuts the scene for two ranks, `sizes="sizes.csv"`
    """
    if isinstance(case, Case):
        case = case.save(_stem(output, ".scene.h5") + ".toml")
    ranks = options.pop("ranks", None)  # of the scene, not of this call
    changes = [f"{key}={value_text(plain(value))}" for key, value in (set or {}).items()]
    cut = ["--ranks", ranks] if ranks is not None else []
    call("decomposer", "pack", case, *cut, output=output, set=changes, **options)
    return Scene(output)


def solve(scene: Path, output: Path | None = None, ranks: int = 1, threads: int | None = None, restart: str | None = None, **options: Any) -> Run:
    """Runs a scene with `scree-solver`; returns the run.

    scene    a file, or the Scene of `pack`
    output   NAME.run; None: the name of the scene
    ranks    MPI ranks; threads of each
    restart  "latest", "auto" or a checkpoint file, to continue a run
    options  as of `call`: `progress=False`, `checkpoint_interval="10 min"`
    Raises RunInvalid when the simulation became invalid; what it wrote until then can be opened.
    """
    folder = output if output is not None else _stem(scene, ".scene.h5") + ".run"
    call("solver", scene, ranks=ranks, threads=threads, output=folder, restart=restart, **options)
    return Run(folder)


def report(run: Path, output: Path | None = None, **options: Any) -> str:
    """Writes the report of a run with `scree-post report`; returns the path of the page.

    run      a folder, or a Run; output: NAME.html; None: NAME.report.html beside NAME.run
    options  as of `call`: `json="numbers.json"`, `frame=10`
    """
    page = os.fspath(output) if output is not None else _stem(run, ".run") + ".report.html"
    call("post", "report", run, output=page, **options)
    return page


def statistics(run: Path, output: Path | None = None, **options: Any) -> Statistics:
    """Writes the statistics of a run with `scree-post statistics`; returns them.

    run      a folder, or a Run; output: folder; None: NAME.statistics beside NAME.run
    options  as of `call`: `from_=2`, `region=["top=box:..."]`, `by_material=True`, `profile=["z:20"]`, `no_charts=True`
    """
    folder = os.fspath(output) if output is not None else _stem(run, ".run") + ".statistics"
    call("post", "statistics", run, output=folder, **options)
    return Statistics(folder)
