"""Python of a study, run if the study is installed or the command allows it, and plug-ins from the command line."""

import ast
import hashlib
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, is_dataclass
from importlib.util import find_spec
from inspect import getmembers, isclass, isfunction, unwrap
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

from runner.base.errors import RunnerError
from runner.papers.study.results import MissingError
from runner.plugins.discovery import entry_point, named_part
from runner.plugins.folder_code import folder_module


class StudyCode:
    """The modules of a study's folder.

    Args:
        folder: The folder.
        package: The installed package that it is, such as "runner.papers.studies.thesis"; None for a mere folder.
        allowed: Whether the command allows code of such a folder.

    Attributes:
        runs: Whether it is run.
    """

    def __init__(self, folder: Path, package: str | None, allowed: bool) -> None:
        self._folder, self._package = folder, package or ""
        self.runs = package is not None or allowed

    def functions(self, stem: str) -> dict[str, Callable[..., Any]]:
        """Return the public functions that a module of the folder defines, by name; none where there is no such module.

        If code may not run, each of them raises MissingError when it is called.

        Raises:
            RunnerError: if the module cannot be imported; names the place.
        """
        path = self._folder / f"{stem}.py"
        if not path.is_file():
            return {}
        if not self.runs:
            return {name: _not_run(path) for name in _defined(path)}
        return public_functions(folder_module(self._folder, stem, self._package))

    def values(self, stem: str) -> tuple[type, ...]:
        """Return the frozen dataclasses of the folder that a module uses: chapters hand their values on as they are."""
        if not self.runs or not (self._folder / f"{stem}.py").is_file():
            return ()
        module = folder_module(self._folder, stem, self._package)
        return tuple(
            each
            for _, each in getmembers(module, isclass)
            if is_dataclass(each) and each.__module__.rpartition(".")[0] == module.__name__.rpartition(".")[0]
        )

    def about(self) -> str:
        """Return a digest of all Python in the folder, and whether it was run; nothing where there is none."""
        files = sorted(self._folder.rglob("*.py"))
        if not files:
            return ""
        digest = hashlib.sha256(b"\0".join(path.read_bytes() for path in files)).hexdigest()[:24]
        return digest if self.runs else f"{digest}, not run: it was made without --code"


def public_functions(module: ModuleType) -> dict[str, Callable[..., Any]]:
    """Return the public functions that a module itself defines, cached ones as well, by name."""
    return {
        name: function
        for name, function in getmembers(module, lambda each: isfunction(unwrap(each)))
        if function.__module__ == module.__name__ and not name.startswith("_")
    }


def _not_run(path: Path) -> Callable[..., NoReturn]:
    def refuse(*_: object, **__: object) -> NoReturn:
        raise MissingError(f"{path.name} was not run: code in a folder runs only with --code")

    return refuse


def _defined(path: Path) -> list[str]:
    """Return the public functions of a module without running it."""
    try:
        tree = ast.parse(path.read_text(encoding="utf-8"))
    except (SyntaxError, ValueError) as error:
        raise RunnerError(f"{path.name} cannot be read: {error}") from error
    return [node.name for node in tree.body if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")]


@dataclass(frozen=True)
class UserPlugin:
    """A user-supplied part of a study.

    Attributes:
        group: Its config group, such as "controller".
        name: What the group calls it.
        module: What names its module: a file, or a module that Python finds.
        folder: The folder of its module, which contains its config as GROUP/NAME.yaml.
        function: True if it is one function, which needs no config.
    """

    group: str
    name: str
    module: str
    folder: Path
    function: bool = False

    @property
    def override(self) -> str:
        """Override that chooses it for a run."""
        return f"{self.group}={self.name}"

    @property
    def options(self) -> tuple[str, ...]:
        """Options of a command that uses it."""
        folders = [word for folder in self.config_dirs for word in ("--config-dir", os.path.relpath(folder))]
        return *folders, "--plugin", named_part(f"{self.group}={self.module}")

    @property
    def config_dirs(self) -> tuple[Path, ...]:
        """Config folders that it needs."""
        return () if self.function else (self.folder,)


def read_user_plugins(lines: Sequence[str]) -> tuple[UserPlugin, ...]:
    """Return parts from what names them, GROUP=MODULE each, files by their whole paths.

    Raises:
        RunnerError: if the folder of a module does not contain the config.
    """
    parts = [_part(line) for line in lines]
    for part in parts:
        config = part.folder / part.group / f"{part.name}.yaml"
        if not (part.function or config.is_file()):
            raise RunnerError(f"--plugin {part.group}={part.module}: no config next to it, {config}")
    return tuple(parts)


def _part(line: str) -> UserPlugin:
    point = entry_point(line)
    spec = find_spec(point.module)
    folder = Path(spec.origin).parent if spec is not None and spec.origin else Path()
    group, _, module = line.partition("=")
    return UserPlugin(group, point.name, module, folder, bool(point.attr))
