"""What makes two runs the same run."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from functools import cache, lru_cache
from importlib.metadata import version
from typing import Any

from runner.paths import package_dir
from runner.plugins import GROUPS, added, source_files

# These say where and under which name a run is kept, and what is told of it, not what is simulated.
_LEFT_OUT = ("caveats", "limits", "outputs", "preset", "sweep")
# The rooms and modules of the physics: what a run's result follows from. All others leave it as it is.
_PHYSICS = (
    "assembly.py", "calibration", "calibration_job.py", "config", "controllers", "environments", "execution.py",
    "feasibility.py", "guard", "interaction.py", "loop", "metrics", "plants", "registry.py", "robots", "sensing",
    "simulation.py", "trace.py", "trajectories",
)  # fmt: skip


def run_hash(resolved: Mapping[str, Any], urdf: str) -> str:
    """Return the name of a run's folder: SHA-256 over all that its result follows from.

    That is the resolved config (without outputs, sweep, limits, caveats, and preset, whose values the groups have
    taken), the URDF's text, the source of the physics and of the user's parts that it uses, and the versions of
    PyBullet and Pinocchio.
    """
    content = {
        "config": simulated_part(resolved),
        "urdf": urdf,
        "source": source_digest(),
        "parts": _parts_digest(tuple(sorted(_parts(resolved)))),
        "engines": _engines(),
    }
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:24]


def simulated_part(resolved: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a config that decide about the result."""
    return {key: value for key, value in resolved.items() if key not in _LEFT_OUT}


def _parts(resolved: Mapping[str, Any]) -> set[str]:
    """Return the modules of the user's parts that a run uses: those whose kinds its config names, and all metrics."""
    kinds = set(_kinds(resolved))
    return {point.value for group in GROUPS for point in added(group) if group == "metric" or point.name in kinds}


def _kinds(value: object) -> Iterator[str]:
    """Yield every `kind` that a config names, at whatever depth."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from [str(inner)] if key == "kind" else _kinds(inner)


@cache
def _engines() -> dict[str, str]:
    return {name: version(name) for name in ("pybullet", "pin")}


@cache
def source_digest() -> str:
    """Return a digest of the source of the physics, ours."""
    digest = hashlib.sha256()
    root = package_dir()
    for path in sorted(root.rglob("*.py")):
        if path.relative_to(root).parts[0] in _PHYSICS:
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


@lru_cache(maxsize=16)
def _parts_digest(modules: tuple[str, ...]) -> str:
    """Return a digest of the source of the user's parts, as it is when they are first used."""
    digest = hashlib.sha256()
    for module in modules:
        for path in source_files(module):
            digest.update(f"{module} {path.name}".encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
