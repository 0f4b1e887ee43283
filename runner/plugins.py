"""Parts that other installed packages add through entry points."""

import sys
from functools import cache
from importlib.metadata import EntryPoint, entry_points


def added(kind: str) -> tuple[EntryPoint, ...]:
    """Return the parts that other packages add, such as those in `runner.plant` for kind "plant".

    Installed packages are read once for each `sys.path`, as that takes half a millisecond and is asked in every run.
    """
    return _read(f"runner.{kind}", tuple(sys.path))


@cache
def _read(group: str, _path: tuple[str, ...]) -> tuple[EntryPoint, ...]:
    return tuple(entry_points(group=group))
