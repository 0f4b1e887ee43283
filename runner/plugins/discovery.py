"""Plug-in discovery: entry points of installed packages, and modules named on the command line.

A plug-in is a module, such as one with a controller's `CONFIG` and `build`. An installed package declares its plug-ins
as entry points in group `runner.<group>`. Any other module must be named on the command line, as in
`runner --plugin controller=mine/spring.py`. A config cannot name one, so a YAML file cannot run code. A controller can
also be one function of a module, as in `controller=mine/laws.py:pd`.
"""

import hashlib
import importlib
import inspect
import os
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from runner.base.entry_points import EntryPoint, entry_points_of
from runner.base.errors import ConfigError, RunnerError, describe_part_error, nearest, unknown
from runner.base.former_names import explain_module

GROUPS = (
    "calibration", "controller", "endpoint_sensor", "environment", "joint_torque_sensor", "metric", "mismatch", "noise",
    "plant", "section", "trajectory", "wrist_sensor",
)  # fmt: skip
"""Groups in which a part can be added; runs do not contain a section of a report."""

_VALUES = {"false", "inf", "nan", "null", "true"}  # that a command line takes for something else than a name
_VARIABLE = "RUNNER_PLUGINS"  # one part a line, with absolute paths of files; worker processes inherit it


def use_plugins(given: Sequence[str]) -> None:
    """Add parts in this process and in its worker processes.

    A part replaces an earlier one of the same group and name.

    Args:
        given: Parts as GROUP=MODULE. MODULE is a file, as in "controller=mine/spring.py", or a module on the Python
            path, as in "controller=mine.spring". Both add the kind `spring`. A controller can also be a function of a
            module: "controller=mine/laws.py:pd" adds the kind `pd`.

    Raises:
        RunnerError: if a group does not exist, or a module or function cannot be found.
    """
    lines = list(in_use())
    for text in given:
        group, _, place = text.partition("=")
        module, function = _split(place)
        if group in GROUPS and not module:
            raise RunnerError(f"--plugin {text}: must be GROUP=MODULE, as in {group}=mine/part.py")
        if group not in GROUPS:
            raise RunnerError(
                f"--plugin {text}: must be GROUP=MODULE, as in controller=mine/spring.py{nearest(group, GROUPS)}; "
                f"groups: {', '.join(GROUPS)}"
            )
        if _is_file(module):
            if not Path(module).is_file():
                raise RunnerError(f"--plugin {text}: no file {module}")
            module = str(Path(module).resolve())
        line = f"{group}={module}{function}"
        point = entry_point(line)
        if point.name.lower() in _VALUES:
            raise RunnerError(f"--plugin {text}: Hydra reads {group}={point.name} as a value, not as a name; rename it")
        _check_found(text, point.module, module)
        if function:
            _check_function(text, point)
        lines = [each for each in lines if not each.startswith(f"{group}=") or entry_point(each).name != point.name]
        lines.append(line)
    os.environ[_VARIABLE] = "\n".join(lines)


def use_only(parts: Sequence[str]) -> None:
    """Replace the parts in use, because a worker serves several commands; takes the value of `in_use`.

    Raises:
        RunnerError: if a module cannot be found.
    """
    os.environ[_VARIABLE] = ""
    use_plugins(parts)


def in_use() -> tuple[str, ...]:
    """Return the parts named on the command line in the form that `use_plugins` takes, with absolute paths of files."""
    return tuple(os.environ.get(_VARIABLE, "").splitlines())


def named_parts() -> list[str]:
    """Return the parts named on the command line as GROUP=MODULE, with paths relative to the working directory."""
    return [named_part(line) for line in in_use()]


def named_part(line: str) -> str:
    """Return a part as GROUP=MODULE with the path of a file relative to the working directory."""
    group, _, place = line.partition("=")
    module, function = _split(place)
    return f"{group}={os.path.relpath(module) if _is_file(module) else module}{function}"


def added_parts(group: str) -> tuple[EntryPoint, ...]:
    """Return the parts of a group from outside this package."""
    of_command_line = [entry_point(line) for line in in_use() if line.partition("=")[0] == group]
    return (*of_command_line, *entry_points_of(group))


def has_users_parts() -> bool:
    """Return True if user-supplied parts of runs are in use; the parts of built-in studies do not count."""
    points = (point for group in GROUPS if group != "section" for point in added_parts(group))
    return any(not point.value.startswith("runner.") for point in points)


def functions_in_use(group: str) -> tuple[EntryPoint, ...]:
    """Return the parts of a group that are one function."""
    return tuple(point for point in added_parts(group) if point.attr)


def load(group: str, name: str, module: str) -> ModuleType:
    """Import a part's module, given by its name; a function after the name has no effect.

    Raises:
        ConfigError: if the import fails; the message contains the line in the module.
    """
    module = _split(module)[0]
    try:
        return importlib.import_module(module)
    except Exception as error:
        if module.startswith("runner."):
            raise
        renamed = explain_module(error.name or "") if isinstance(error, ModuleNotFoundError) else ""
        raise ConfigError(
            f"{group} {name}: module {module} cannot be imported: {renamed or describe_part_error(error)}"
        ) from error


def source_files(module: str) -> list[Path]:
    """Return the source files of a part: the file of its module, or all files of its top-level package.

    For a part of a built-in study, these are the files in the folder `parts` of the study.
    """
    module = _split(module)[0]
    package, _, rest = module.rpartition(".") if module.startswith("runner.") else module.partition(".")
    spec = find_spec(package if rest else module)
    if spec is None:
        return []
    if spec.submodule_search_locations:
        return sorted(path for folder in spec.submodule_search_locations for path in Path(folder).rglob("*.py"))
    return [Path(spec.origin)] if spec.origin else []


def entry_point(line: str) -> EntryPoint:
    """Return a part given as GROUP=MODULE; the folder of a file is added to `sys.path`."""
    group, _, place = line.partition("=")
    module, function = _split(place)
    if _is_file(module):
        folder = str(Path(module).parent)
        if folder not in sys.path:
            sys.path.append(folder)  # last, so that its modules do not hide installed ones
        module = Path(module).stem
    name = function[1:] or module.rpartition(".")[2]
    return EntryPoint(name, f"{module}{function}", f"runner.{group}")


def digests() -> dict[str, str]:
    """Return a digest of the source of each part named on the command line, by the part as `named_parts` returns it."""
    found = {}
    for text in named_parts():
        content = b"\0".join(path.read_bytes() for path in source_files(entry_point(text).value))
        found[text] = hashlib.sha256(content).hexdigest()[:24]
    return found


def _is_file(module: str) -> bool:
    return module.endswith(".py")


def _split(place: str) -> tuple[str, str]:
    """Return a module or file, and its function with a leading colon, or an empty string, from MODULE:FUNCTION."""
    module, colon, function = place.rpartition(":")
    return (module, f":{function}") if colon and function.isidentifier() else (place, "")


def _check_found(text: str, name: str, module: str) -> None:
    try:
        spec = find_spec(name)
    except (ImportError, ValueError) as error:
        raise RunnerError(f"--plugin {text}: no module {name}: {error}") from error
    if spec is None:
        raise RunnerError(f"--plugin {text}: no module {name}; name a file, as in {name.replace('.', '/')}.py")
    if _is_file(module) and (spec.origin is None or Path(spec.origin).resolve() != Path(module)):
        raise RunnerError(f"--plugin {text}: Python has another module {name}, {spec.origin}; rename yours")


def _check_function(text: str, point: EntryPoint) -> None:
    group = point.group.removeprefix("runner.")
    if group != "controller":
        raise RunnerError(f"--plugin {text}: only a controller can be a function; give {group}=MODULE")
    module = load(group, point.name, point.module)
    if point.attr not in vars(module):
        own = [name for name, value in vars(module).items() if inspect.isfunction(value)]
        raise RunnerError(
            unknown(f"function in {Path(module.__file__ or '').name}", point.attr, own, f"--plugin {text}")
        )
