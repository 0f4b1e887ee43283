"""The modules of the commands: our own, those of guests in this package, and those of installed packages.

A guest is a package in `runner/` with a folder `commands`, such as runner/papers; nothing else imports it. An installed
package declares a command as an entry point of group `runner.command`, whose name is the command.

The module of a command has a docstring, `add_arguments(parser)` and `run(arguments) -> exit code`. It may also have

- `TOPICS`: topics of `runner list`, each with a function from config folders to names with one-line descriptions;
- `find_document(path)`: for `runner figures`: a function that returns the document of a path and its folder, for a path
  other than a stored result; None for an unknown path.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from runner.base.entry_points import entry_points_of
from runner.base.paths import package_dir

if TYPE_CHECKING:
    from runner.reporting.document import Document

GROUP = "command"
"""The group of entry points, after `runner.`."""
OWN = {
    "Run experiments": ("run", "sweep", "status", "tune", "calibrate"),
    "Question a result": ("compare", "challenge", "check", "sensitivity", "verify"),
    "Look at results": ("results", "report", "table", "figures"),
    "Real arms": ("doctor", "identify"),
    "Set up": ("list", "schema", "example"),
}
"""Names of the commands of this package, by what a person wants to do."""
OVERRIDES = ("run", "sweep")
"""Commands whose line is overrides and flags of Hydra; `run` is the command of a line that names none."""

Topic = Callable[[Sequence[Path]], dict[str, str]]
Compose = Callable[[], "tuple[Document, Path]"]


@cache
def guests() -> Mapping[str, Mapping[str, str]]:
    """Return the modules of the commands of each guest, by the guest's name; reads no metadata of packages."""
    found: dict[str, dict[str, str]] = {}
    for path in sorted(package_dir().glob("*/commands/[!_]*.py")):
        guest = path.parents[1].name
        found.setdefault(guest.capitalize(), {})[path.stem] = f"runner.{guest}.commands.{path.stem}"
    return found


def groups() -> dict[str, tuple[str, ...]]:
    """Return the names of the commands by group, without those of installed packages."""
    return OWN | {guest: tuple(modules) for guest, modules in guests().items()}


def names() -> tuple[str, ...]:
    """Return the names of all commands, without those of installed packages."""
    return tuple(name for commands in groups().values() for name in commands)


def installed() -> dict[str, str]:
    """Return the modules of the commands of installed packages, by name; takes milliseconds."""
    return {point.name: point.value for point in entry_points_of(GROUP) if point.name not in names()}


def module_of(name: str) -> str:
    """Return the name of a command's module."""
    for modules in guests().values():
        if name in modules:
            return modules[name]
    if name in names():
        return f"runner.cli.{'run' if name in OVERRIDES else name}"
    return installed()[name]


def load(name: str) -> ModuleType:
    """Import a command's module.

    Raises:
        ConfigError: if that of an installed package cannot be imported; names its line.
    """
    from runner.plugins.discovery import load

    return load(GROUP, name, module_of(name))


def summary(name: str) -> str:
    """Return the first sentence of a command's description; reading it is faster than an import."""
    spec = find_spec(module_of(name))
    parts = Path(spec.origin).read_text(encoding="utf-8").split('"""') if spec is not None and spec.origin else []
    return " ".join(parts[1].partition("\n\n")[0].split()) if len(parts) > 1 else ""


def guests_topics() -> dict[str, Topic]:
    """Return the topics that guests add to `runner list`; reads no metadata of packages."""
    return _topics(name for modules in guests().values() for name in modules)


def installed_topics() -> dict[str, Topic]:
    """Return the topics that installed packages add to `runner list`."""
    return _topics(installed())


def _topics(commands: Iterable[str]) -> dict[str, Topic]:
    return {topic: function for name in commands for topic, function in vars(load(name)).get("TOPICS", {}).items()}


def find_document(path: Path) -> Compose | None:
    """Return the function that composes the document of a path that a guest or an installed package knows, or None."""
    others = (*(name for modules in guests().values() for name in modules), *installed())
    finders = (vars(load(name)).get("find_document") for name in others)
    return next((found for finder in finders if finder is not None and (found := finder(path)) is not None), None)
