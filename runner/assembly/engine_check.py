"""Comparison of a run's engine with Pinocchio when a user's robot file is first used; the result is kept."""

import hashlib
import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from runner.assembly.arms import ArmOutline, RobotOutline
from runner.base.cache import read_answer, write_answer
from runner.base.engines import has_pybullet, installed_versions
from runner.base.errors import ConfigError
from runner.base.paths import robots_dir
from runner.plants import PlantConfig
from runner.plants.agreement import ENGINES, compare
from runner.robots.description import mjcf_of, read_urdf
from runner.robots.inertials import set_file
from runner.robots.model import RobotModel

_SAMPLES = 3
_REGULAR = 1e-9  # smallest eigenvalue of a mass matrix with a diagonal of 1


def check_engine(outline: RobotOutline, plant: PlantConfig) -> None:
    """Check that a run's engine simulates the arms of a user's files as Pinocchio does; see compare.

    A test compares the built-in arms instead. Where PyBullet is not installed, plant=bullet is not compared.

    Raises:
        ConfigError: if it does not, with the joint or link that differs first.
    """
    if plant.kind not in ENGINES or (plant.kind == "bullet" and not has_pybullet()):
        return
    problems = []
    for arm in outline.stages:
        if not arm.path.is_relative_to(robots_dir()):
            difference = _difference(plant.kind, arm.path, _stamps(arm), arm.config.inertials, arm.config.tip)
            if difference:
                engine = ENGINES[plant.kind]
                message = f"robot: {engine} and Pinocchio simulate {arm.path} differently: {difference}"
                problems.append(f"{message}. Take plant=rk4, or look at it by `runner doctor {arm.path.name}`")
    if problems:
        raise ConfigError(problems)


def _stamps(arm: ArmOutline) -> tuple[tuple[Path, int, int], ...]:
    """Return the files of an arm with modification time and size."""
    files: Sequence[Path] = (*(mjcf_of(arm.path).files if arm.config.mjcf else [arm.path]), set_file(arm.path))
    return tuple((file, file.stat().st_mtime_ns, file.stat().st_size) for file in files if file.exists())


@lru_cache(maxsize=64)
def _difference(kind: str, path: Path, stamps: object, inertials: str | None, tip: str) -> str:
    """Return the first difference of an engine from Pinocchio; empty without one, or without mass."""
    urdf = read_urdf(path, {}, 0.0, inertials)
    versions = installed_versions(("arm-control-runner", "mujoco", "pin", "pybullet"))
    key = hashlib.sha256(json.dumps([kind, urdf, versions]).encode()).hexdigest()
    found = read_answer(f"engine-{key}")
    if not isinstance(found, str):
        model, generator = RobotModel(urdf, tip), np.random.default_rng(0)
        found = compare(kind, urdf, model, _SAMPLES, generator).difference if _is_regular(model) else ""
        write_answer(f"engine-{key}", found)
    return found


def _is_regular(model: RobotModel) -> bool:
    """Return True if torques can move each joint."""
    M = model.mass_matrix(model.usual_range.mean(axis=0))
    size = np.sqrt(np.maximum(np.diagonal(M), 1e-300))
    return bool(np.linalg.eigvalsh(M / np.outer(size, size))[0] > _REGULAR)
