"""Errors of Scree as exceptions.

Each class stands for one exit code of the tools. The package itself raises the same classes: a damaged file is an InputError
whether a tool or this package finds it.
"""
from __future__ import annotations

import signal
from collections.abc import Iterable, Sequence


class ScreeError(Exception):
    """An error that Scree reports. The message says where it is, what was found, and what to do.

    exit_code  of the tool; the code that a tool would end with when the package itself found the error
    message    the error alone, without the name of the tool
    command    words of the call of the tool; empty when the package found the error
    output     all that the tool wrote to stderr
    """

    exit_code: int = 1

    def __init__(self, message: str, *, exit_code: int | None = None, command: Sequence[str] = (), output: str = "") -> None:
        super().__init__(message)
        self.message = message
        if exit_code is not None:
            self.exit_code = exit_code
        self.command = tuple(command)
        self.output = output

    def __str__(self) -> str:
        return self.message


class InternalError(ScreeError):
    """Exit code 1: a fault of Scree itself. Please report it, with the command and its output."""

    exit_code = 1


class UsageError(ScreeError):
    """Exit code 2: an error in a call, in the command line or in a case."""

    exit_code = 2


class UnknownName(UsageError, KeyError):
    """A shape, material, column, body or wall that does not exist; the message lists those that do. Also a KeyError."""


class InputError(ScreeError):
    """Exit code 3: a file is damaged, missing, of a newer version, or its contents cannot be used."""

    exit_code = 3


class MachineError(ScreeError):
    """Exit code 4: the disk, MPI or the display failed."""

    exit_code = 4


class RunInvalid(ScreeError):
    """Exit code 5: the simulation became invalid, for instance a body passed all of its margins. The run folder can still be opened."""

    exit_code = 5


class Interrupted(ScreeError):
    """Exit code 128 + n: signal n stopped the tool. The solver writes a checkpoint first; `solve(..., restart="latest")` continues."""

    exit_code = 128

    @property
    def signal(self) -> int:
        """Number of the signal."""
        return self.exit_code - 128


class MissingPackage(ScreeError, ImportError):
    """An optional Python package is not installed; the message names it and the command that installs it. Also an ImportError."""

    exit_code = 4


def error_of(exit_code: int, message: str, command: Sequence[str], output: str) -> ScreeError:
    """The exception for an exit code of a tool."""
    if exit_code >= 128:
        try:
            name = signal.Signals(exit_code - 128).name
        except ValueError:
            name = f"signal {exit_code - 128}"
        return Interrupted(f"{message or command[0]}: stopped by {name}", exit_code=exit_code, command=command, output=output)
    kinds = (InternalError, UsageError, InputError, MachineError, RunInvalid)
    kind = {error.exit_code: error for error in kinds}.get(exit_code, InternalError)
    return kind(message or f"{command[0]} ended with exit code {exit_code}", exit_code=exit_code, command=command, output=output)


def unknown_name(kind: str, name: object, known: Iterable[object]) -> UnknownName:
    """The error for a name that is none of the known ones."""
    names = [str(k) for k in known]
    shown = ", ".join(names[:20]) + (f" and {len(names) - 20} more" if len(names) > 20 else "")
    return UnknownName(f"{kind} '{name}' does not exist; there are: {shown or 'none'}")


def missing_package(what: str, package: str) -> MissingPackage:
    """The error for an optional package that is not installed."""
    debian = f"apt-get install python3-{package}, or " if package in ("matplotlib", "pandas") else ""  # Debian 12 has these
    return MissingPackage(f"{what} needs the Python package {package}: {debian}pip install {package}")
