"""Exceptions and error messages.

Every error that a user can fix derives from RunnerError and ends with exit code 2.

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
"""What the system says of a disk that takes no more."""
_PROBLEMS_SHOWN = 20
_LISTED = 1500  # characters of the allowed names in a message


class RunnerError(Exception):
    """Base of all errors that a user can mend: the message says what is wrong, what was found and what is allowed.

    Whatever stands in it of values and names from outside, it is safe to print and no line is longer than one can read.
    """

    def __init__(self, text: str) -> None:
        super().__init__(lines(text))


class ConfigError(RunnerError):
    """A config that cannot be run; carries one message per problem.

    Attributes:
        problems: One text per problem: dotted key, value found, values allowed; the message shows the first 20.
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
        """Come out of a worker process as it went in."""
        return ConfigError, (self.problems, self.hint)


class StoreError(RunnerError):
    """A run folder, sweep folder or baseline that cannot be read or written."""


class SimulationError(Exception):
    """A closed loop that left the domain of its equations: a result to be stored, not a crash.

    Attributes:
        reason: What happened.
        time: When, in s; NaN if unknown.
        joint: Name of the joint that left first, or None.
    """

    def __init__(self, reason: str, time: float = math.nan, joint: str | None = None) -> None:
        self.reason, self.time, self.joint = reason, time, joint
        at = "" if math.isnan(time) else f" at t = {time:.4g} s" + (f", {joint}" if joint else "")
        super().__init__(f"{reason}{at}")


def describe_write_error(error: OSError, path: Path | None = None) -> str:
    """Return that a file cannot be written, why, and what to do about it where its disk is full."""
    name = path or error.filename or "the output, or a temporary file where TMPDIR says"
    return f"cannot write {name}: {error.strerror}" + ("; free space on its disk" if error.errno in DISK_FULL else "")


def nearest(name: str, allowed: Iterable[str]) -> str:
    """Return " (did you mean X?)" for the nearest allowed name, or an empty text when none is near."""
    near = _nearest(name, allowed)
    return f" (did you mean {near}?)" if near else ""


def unknown(what: str, name: object, allowed: Iterable[str], place: str = "") -> str:
    """Return the message on an unknown name: what is allowed, and the nearest name.

        >>> unknown("axis", "rob", ["robot", "seed"], "--by")
        "--by: unknown axis 'rob'. Allowed: robot, seed. Did you mean 'robot'?"

    Args:
        what: Noun for the thing that the name names, such as "axis".
        name: The name as given.
        allowed: The allowed names.
        place: The option, command or file that has the name; empty for none.
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
    """Return what an error of a user's part says, with the innermost place in the user's own source."""
    import traceback

    text = traceback.format_exception_only(error)[-1].strip()
    if isinstance(error, SyntaxError):
        return f"{text} ({Path(error.filename or '?').name}, line {error.lineno})"
    frames = _frames(error)
    place = user_place(error) or (_place(frames[0]) if frames else "")  # that of a part which is installed as a package
    return f"{text} ({place})" if place else text


def user_place(error: BaseException) -> str:
    """Return the innermost place in the user's own files where an error arose, or an empty text."""
    import sysconfig

    libraries = tuple(sysconfig.get_paths()[name] for name in ("purelib", "platlib", "stdlib"))
    own = [frame for frame in _frames(error) if not frame.filename.startswith(libraries)]
    return _place(own[-1]) if own else ""


def _frames(error: BaseException) -> "list[traceback.FrameSummary]":
    """Return where an error passed outside of this package."""
    import traceback

    ours = str(Path(__file__).resolve().parents[1])
    frames = traceback.extract_tb(error.__traceback__)
    return [frame for frame in frames if not frame.filename.startswith((ours, "<frozen"))]


def _place(frame: "traceback.FrameSummary") -> str:
    return f"{Path(frame.filename).name}, line {frame.lineno}, in {frame.name}"
