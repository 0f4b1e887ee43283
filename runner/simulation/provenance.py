"""Provenance of a result: command, commit, versions and machine."""

import os
import shlex
import subprocess
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.assembly.dependent_keys import idle_keys
from runner.assembly.versions import versions
from runner.base.machine import this_machine, today
from runner.base.paths import package_dir
from runner.plugins import discovery

if TYPE_CHECKING:
    from runner.assembly.run_config import RunConfig
    from runner.config.composed import Composed


def describe_origin(composed: "Composed", *subcommand: str) -> dict[str, Any]:
    """Return the origin of a result: date, command, digests of plug-ins, commit, versions, machine.

    Args:
        composed: The composed config.
        subcommand: Words after `runner` in the command; none for a run.
    """
    return {
        "date": today(),
        "command": command(composed, *subcommand),
        "plugins": discovery.digests(),
        "commit": commit(),
        "versions": versions(),
        "machine": this_machine().record(),
    }


def job_provenance(config: "RunConfig", notices: Sequence[str] = ()) -> dict[str, Any]:
    """Return the provenance of a run: origin, choices, time steps, seed, warnings."""
    return {
        **describe_origin(config.composed),
        "choices": dict(config.composed.choices),
        "plant_step": config.timing.step,
        "steps_per_tick": config.timing.steps_per_tick,
        "tip_frame": config.arm.model.tip_name,
        "stages": {stage.name: stage.base_frame for stage in config.arm.stages},
        "joints": list(config.arm.model.joint_names),
        "seed": config.settings.seed,
        "warnings": [*config.warnings, *idle_keys(config), *notices],
    }


def command(composed: "Composed", *subcommand: str) -> str:
    """Return the command for a composed config, with folders relative to the working directory."""
    added = [word for text in discovery.named_parts() for word in ("--plugin", text)]
    own = [word for folder in composed.config_dirs for word in ("--config-dir", os.path.relpath(folder))]
    resolved: Any = composed.resolved
    kept = [
        override for override in portable_overrides(composed.overrides, resolved) if not override.startswith("outputs=")
    ]
    return " ".join(map(_quoted, ["runner", *added, *subcommand, *own, *kept]))


def portable_overrides(overrides: Sequence[str], config: Mapping[str, Any]) -> list[str]:
    """Return overrides that give the same run on any machine: they name the plant instead of `default`.

    Args:
        overrides: The given overrides.
        config: The resulting config.
    """
    name = f"plant={config.get('plant', {}).get('kind')}"
    return [name if override == "plant=default" else override for override in overrides]


_quoted = lru_cache(4096)(shlex.quote)


@cache
def commit() -> str | None:
    """Return the checkout's commit, with "+changes" when files differ from it.

    Returns:
        None without a checkout of this package. Another repository that contains an installed copy, or that variables
        such as GIT_DIR name, says nothing about the package.
    """
    package = package_dir()
    try:
        of_package = f"{package.name}/__init__.py"
        if _git(package, "ls-files", "--full-name", "__init__.py") != of_package:
            return None
        head, changes = _git(package, "rev-parse", "HEAD"), _git(package, "status", "--porcelain", "-uno")
    except (OSError, subprocess.SubprocessError):
        return None
    return head + ("+changes" if changes else "")


def _git(folder: Path, *words: str) -> str:
    return subprocess.run(
        ["git", "-C", str(folder), *words],
        env={name: value for name, value in os.environ.items() if not name.startswith("GIT_")},
        capture_output=True,
        text=True,
        check=True,
        timeout=10,
    ).stdout.strip()
