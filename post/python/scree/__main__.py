"""Commands: frames and packings for other programs, and back. `python3 -m scree --help` describes them."""
from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from .case import Case
from .errors import ScreeError, UsageError
from .frames import Frames
from .h5md import write_h5md
from .packings import Packing
from .run import Run

_EXAMPLES = """\
examples:
  python3 -m scree h5md bed.run -o bed.h5md                  # all frames, nothing copied
  python3 -m scree export bed.run -o bed.data                # the last frame as spheres, for LAMMPS or LIGGGHTS; also .dump .txt (Yade) .vtp
  python3 -m scree import bed.data --case balls.toml --shape ball --material glass -o bed.toml
exit codes: 0 done, 2 wrong command or case, 3 a file is damaged, missing or newer (file and line are named), 4 cannot be written
"""
_MANY = 900  # frames, each an open file of a reader; 1024 is the usual limit
_FORMATS = ("lammps-data", "lammps-dump", "yade", "vtp")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m scree", description="Frames and packings for other programs, and back.", epilog=_EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    h5md = commands.add_parser("h5md", help="frames of a run as H5MD 1.1", description="Writes frames of a run as H5MD 1.1, by default as windows "
                               "on the frame files, which must stay where they are relative to the output.")
    h5md.add_argument("run", metavar="NAME.run")
    h5md.add_argument("-o", "--output", required=True, metavar="NAME.h5md")
    h5md.add_argument("--frames", default="all", help="all, last, 7, 0,5,-1, 10:50, ::5 (first:last:step, both included); the numbers are those of the files")
    h5md.add_argument("--copy", action="store_true", help="copy all values into the file, rows by ascending id")
    h5md.add_argument("--no-units", action="store_true", help="leave out the units, for programs that do not know metres, such as MDAnalysis")

    export = commands.add_parser("export", help="a frame as spheres, for LAMMPS, LIGGGHTS, Yade, VTK", description="Writes the bodies of a frame as "
                                 "spheres, in SI units. A body with a mesh becomes the sphere of equal volume.")
    export.add_argument("run", metavar="NAME.run")
    export.add_argument("-o", "--output", required=True, metavar="FILE", help="its ending says the format: .data .lmp (LAMMPS data), "
                        ".dump .lammpstrj .liggghts (LAMMPS dump), .txt .spheres (Yade), .vtp")
    export.add_argument("--format", choices=_FORMATS, help="whatever the ending is")
    export.add_argument("--frame", type=int, default=-1, metavar="N", help="as in the name of the file; -1 (default) is the last, -2 the one before")
    export.add_argument("--region", metavar="REGION", help="only bodies with their centre in it: box:x0,y0,z0,x1,y1,z1, cylinder:..., sphere:x,y,z,r")
    export.add_argument("--shape", help="only bodies of this shape")
    export.add_argument("--all", action="store_true", help="fixed bodies and apparatus too")

    bring = commands.add_parser("import", help="spheres from LAMMPS, LIGGGHTS, Yade or VTK as bodies of a case", description="Adds the spheres of a "
                                "file to a case as [[bodies]], with their velocities. The format is known from the contents.")
    bring.add_argument("file", metavar="FILE", help="data file or dump of LAMMPS or LIGGGHTS, list of spheres of Yade, .vtp")
    bring.add_argument("--case", required=True, metavar="CASE.toml", help="to which they are added; itself not changed")
    bring.add_argument("-o", "--output", required=True, metavar="NEW.toml")
    bring.add_argument("--shape", required=True, help="a shape of the case, scaled to the radius of each")
    bring.add_argument("--material", required=True, action="append", help="of the case, for all; or, repeated, KIND=NAME for each kind (type) of the file: 2=steel")
    bring.add_argument("--unit", default="m", help="of the lengths in the file: mm, cm; default m")
    bring.add_argument("--radius", help="of all, for a file without radii: \"2 mm\"")
    bring.add_argument("--step", type=int, metavar="N", help="which step of a dump; default: the last")
    bring.add_argument("--format", choices=_FORMATS)
    bring.add_argument("--fixed", action="store_true", help="they never move")
    return parser


def chosen_frames(frames: Frames, text: str) -> Frames:
    """Frames by the language of scree-post's --frames. Raises UsageError."""
    numbers = [frame.number for frame in frames]
    if text == "all" or not numbers:
        return frames
    places: set[int] = set()

    def place(word: str) -> int:
        number = int(word)
        return numbers.index(number) if number >= 0 else range(len(numbers))[number]

    for part in text.split(","):
        try:
            if ":" in part:
                first, last, step = (part.split(":") + [""])[:3]
                if part.count(":") > 2:
                    raise ValueError
                low = int(first) if first and int(first) >= 0 else numbers[place(first)] if first else numbers[0]
                high = int(last) if last and int(last) >= 0 else numbers[place(last)] if last else numbers[-1]
                if step and int(step) < 1:
                    raise ValueError
                places |= {k for k, number in enumerate(numbers) if low <= number <= high and (number - low) % int(step or 1) == 0}
            else:
                places.add(place("-1" if part == "last" else part))
        except (ValueError, IndexError):
            raise UsageError(f"--frames {text}: '{part}' means none of the frames {numbers[0]} to {numbers[-1]}; expected all, last, 7, 0,5,-1, 10:50 or ::5") from None
    if not places:
        raise UsageError(f"--frames {text}: no frame; there are {numbers[0]} to {numbers[-1]}")
    return frames.at(sorted(places))


def _materials(words: Sequence[str]) -> str | dict[int, str]:
    if len(words) == 1 and "=" not in words[0]:
        return words[0]
    kinds: dict[int, str] = {}
    for word in words:
        kind, equals, name = word.partition("=")
        if not equals or not kind.strip().lstrip("-").isdigit():
            raise UsageError(f"--material {word}: KIND=NAME expected, such as 2=steel, where several are given")
        kinds[int(kind)] = name.strip()
    return kinds


def _h5md(words: argparse.Namespace) -> None:
    run = Run(words.run)
    frames = chosen_frames(run.frames, words.frames)
    if not write_h5md(run, words.output, frames, copy=words.copy, units=not words.no_units):
        print("scree: note: rows are not the same body in all frames; for a program that does not read `id`, use --copy", file=sys.stderr)
    if len(frames) > _MANY and not words.copy:
        print(f"scree: note: {len(frames)} frames are as many open files for a program that reads all; beyond its limit (ulimit -n, often 1024) HDF5 gives NaN "
              "without an error: raise the limit there, or use --frames or --copy", file=sys.stderr)
    print(f"{words.output}: {len(frames)} frames, {os.path.getsize(words.output)} bytes")


def _export(words: argparse.Namespace) -> None:
    run = Run(words.run)
    frame = run.frames[words.frame] if words.frame < 0 else run.frames.by_number(words.frame)
    bodies = frame.bodies if words.all else frame.bodies.particles()
    if words.region:
        bodies = bodies.in_region(words.region)
    if words.shape:
        bodies = bodies.of_shape(words.shape)
    packing = Packing.of(bodies)
    packing.step, packing.time = frame.step, frame.time
    packing.write(words.output, words.format)
    meshes = sum(run.shapes.by_index(int(s)).kind != "sphere" for s in bodies.shape)
    if meshes:
        print(f"scree: note: {meshes} of {len(bodies)} bodies have a mesh; they are written as spheres of equal volume", file=sys.stderr)
    print(f"{words.output}: {len(packing)} spheres at {frame.time:.6g} s")


def _import(words: argparse.Namespace) -> None:
    packing = Packing.read(words.file, words.format, words.unit, words.radius, words.step)
    case = Case(words.case)
    packing.add_to(case, words.shape, _materials(words.material), fixed=words.fixed)
    case.save(words.output)
    sizes = f", radius {packing.radius.min():.4g} m to {packing.radius.max():.4g} m" if len(packing) else ""
    print(f"{words.output}: {len(packing)} bodies{sizes}")


def main(words: Sequence[str] | None = None) -> int:
    """Runs a command; returns the exit code."""
    chosen = _parser().parse_args(words)
    try:
        {"h5md": _h5md, "export": _export, "import": _import}[chosen.command](chosen)
    except ScreeError as error:
        print(f"scree: error: {error}", file=sys.stderr)
        return error.exit_code
    except IndexError as error:
        print(f"scree: error: {error}", file=sys.stderr)
        return UsageError.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
