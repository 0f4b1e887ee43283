"""Plug-ins for a study from the command line, as in `runner reproduce benchmark --plugin controller=mine.py`."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from runner.base.errors import RunnerError


@dataclass(frozen=True)
class UserPlugin:
    """A part of the user's that stands beside those of a study.

    Attributes:
        group: Its config group, such as "controller".
        name: What the group calls it.
        module: What names its module: a file, or a module that Python finds.
        folder: The folder of its module, in which its config stands as GROUP/NAME.yaml.
    """

    group: str
    name: str
    module: str
    folder: Path

    @property
    def override(self) -> str:
        """What chooses it for a run."""
        return f"{self.group}={self.name}"

    @property
    def options(self) -> tuple[str, ...]:
        """What a command that uses it has before the overrides."""
        module = os.path.relpath(self.module) if self.module.endswith(".py") else self.module
        return "--config-dir", os.path.relpath(self.folder), "--plugin", f"{self.group}={module}"


def read_user_plugins(lines: Sequence[str]) -> tuple[UserPlugin, ...]:
    """Return parts from what names them, GROUP=MODULE each, files by their whole paths.

    Raises:
        RunnerError: if the config of one does not stand beside its module.
    """
    parts = [_part(*line.split("=", 1)) for line in lines]
    for part in parts:
        config = part.folder / part.group / f"{part.name}.yaml"
        if not config.is_file():
            raise RunnerError(f"--plugin {part.group}={part.module}: no config beside it, {config}")
    return tuple(parts)


def _part(group: str, module: str) -> UserPlugin:
    if module.endswith(".py"):
        return UserPlugin(group, Path(module).stem, module, Path(module).parent)
    spec = find_spec(module)
    folder = Path(spec.origin).parent if spec is not None and spec.origin else Path()
    return UserPlugin(group, module.rpartition(".")[2], module, folder)
