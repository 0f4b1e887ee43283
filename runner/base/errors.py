"""Exceptions and error messages.

Every error that a user can fix derives from RunnerError. It ends with exit code 2, or 75 if the same command continues.

Every command imports this module. It therefore imports code for messages only when a message needs it.
"""

import errno
import itertools
import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from runner.base.sanitize import VALUE, lines, one_line, quoted

if TYPE_CHECKING:
    import traceback

DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Error numbers of a full disk."""
_PROBLEMS_SHOWN = 20
_LISTED = 1500  # characters of the allowed names in a message


class RunnerError(Exception):
    """Base of all errors that a user can fix; the message contains the problem, the value found and allowed values.

    The message is safe to print, and its lines have a limited length, even if it contains external values and names.

    Attributes:
        exit_code: Exit code of a command that ends with this error.
    """

    exit_code = 2

    def __init__(self, text: str) -> None:
        super().__init__(lines(text))


class TemporaryError(RunnerError):
    """Cause that may pass, such as a full disk or a lost scheduler: the same command continues.

    Attributes:
        exit_code: Exit code of a command that ends with this error.
    """

    exit_code = 75  # EX_TEMPFAIL of sysexits.h


class TableError(RunnerError):
    """A file that is not a table of numbers, or lacks a column.

    Attributes:
        problems: A message for each problem, without the file's name.
    """

    def __init__(self, path: Path, *problems: str) -> None:
        super().__init__(f"{path}: {'; '.join(problems)}")
        self.problems = problems


class ConfigError(RunnerError):
    """Config that cannot be run, with one message for each problem.

    Attributes:
        problems: One message for each problem: dotted key, value found, values allowed. The text of the error shows the
            first 20.
    """

    def __init__(self, problems: str | Iterable[str], hint: str = "") -> None:
        self.problems = (problems,) if isinstance(problems, str) else tuple(problems)
        self.hint = hint
        count = len(self.problems)
        head = "1 problem in the config:" if count == 1 else f"{count} problems in the config:"
        shown = [f"  - {one_line(problem)}" for problem in self.problems[:_PROBLEMS_SHOWN]]
        more = [f"  and {count - _PROBLEMS_SHOWN} more"] if count > _PROBLEMS_SHOWN else []
        super().__init__("\n".join([head, *shown, *more, *([hint] if hint else [])]))

    def __reduce__(self) -> tuple[type["ConfigError"], tuple[tuple[str, ...], str]]:
        """Return the arguments for pickling, so that the error passes unchanged out of a worker process."""
        return ConfigError, (self.problems, self.hint)


class StoreError(RunnerError):
    """Run folder, sweep folder or baseline that cannot be read or written."""


class SimulationError(Exception):
    """Closed loop that left the domain of its equations; the runner stores it as a result.

    Attributes:
        reason: Reason of the failure.
        time: Time of the failure, in s; NaN if unknown.
        joint: Name of the joint that failed first, or None.
    """

    def __init__(self, reason: str, time: float = math.nan, joint: str | None = None) -> None:
        self.reason, self.time, self.joint = reason, time, joint
        at = "" if math.isnan(time) else f" at t = {time:.4g} s" + (f", {joint}" if joint else "")
        super().__init__(f"{reason}{at}")


def describe_write_error(error: OSError, path: Path | None = None) -> str:
    """Return a message about a file that cannot be written, with the reason, and a remedy if the disk is full."""
    name = path or error.filename or "the output, or a temporary file where TMPDIR says"
    return f"cannot write {name}: {error.strerror}" + ("; free space on its disk" if error.errno in DISK_FULL else "")


def nearest(name: str, allowed: Iterable[str]) -> str:
    """Return " (did you mean X?)" for the nearest allowed name, or an empty string if none is near."""
    near = _nearest(name, allowed)
    return f" (did you mean {near}?)" if near else ""


def unknown(what: str, name: object, allowed: Iterable[str], place: str = "") -> str:
    """Return the message about an unknown name, with the allowed names and the nearest one.

        >>> unknown("axis", "rob", ["robot", "seed"], "--by")
        "--by: unknown axis 'rob'. Allowed: robot, seed. Did you mean 'robot'?"

    Args:
        what: Noun for the kind of name, such as "axis".
        name: The name as given.
        allowed: The allowed names.
        place: Option, command or file that contains the name, or an empty string.
    """
    known = list(allowed)
    near = _nearest(str(name), known)
    fitting = sum(total <= _LISTED for total in itertools.accumulate(len(each) + 2 for each in known))
    more = f" and {len(known) - fitting} more" if fitting < len(known) else ""
    listed = f"{', '.join(known[:fitting])}{more}" if known else "none"
    hint = f" Did you mean {quoted(near)}?" if near else ""
    return f"{place}{': ' if place else ''}unknown {what} {quoted(name)}. Allowed: {listed}.{hint}"


def _nearest(name: str, allowed: Iterable[str]) -> str:
    """Return the nearest allowed name; empty if none is near."""
    import difflib

    matches = difflib.get_close_matches(name, list(allowed), n=1, cutoff=0.5) if len(name) <= VALUE else []
    return matches[0] if matches else ""


def describe_part_error(error: Exception) -> str:
    """Return the message of an error in a user-supplied part, with the innermost line of user code."""
    import traceback

    text = traceback.format_exception_only(error)[-1].strip()
    if isinstance(error, SyntaxError):
        return f"{text} ({Path(error.filename or '?').name}, line {error.lineno})"
    frames = _frames(error)
    place = user_place(error) or (_place(frames[0]) if frames else "")  # the latter for a part in an installed package
    return f"{text} ({place})" if place else text


def user_place(error: BaseException) -> str:
    """Return the innermost line in user files in the traceback of an error, or an empty string."""
    import sysconfig

    libraries = tuple(sysconfig.get_paths()[name] for name in ("purelib", "platlib", "stdlib"))
    own = [frame for frame in _frames(error) if not frame.filename.startswith(libraries)]
    return _place(own[-1]) if own else ""


def _frames(error: BaseException) -> "list[traceback.FrameSummary]":
    """Return the frames of an error that are outside this package."""
    import traceback

    ours = str(Path(__file__).resolve().parents[1])
    frames = traceback.extract_tb(error.__traceback__)
    return [frame for frame in frames if not frame.filename.startswith((ours, "<frozen"))]


def _place(frame: "traceback.FrameSummary") -> str:
    return f"{Path(frame.filename).name}, line {frame.lineno}, in {frame.name}"
