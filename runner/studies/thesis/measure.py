"""Timing of rigid-body dynamics for chains of mounted arms, stored in a file."""

import timeit
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from runner.base.errors import StoreError
from runner.config.compose.compose import compose
from runner.config.robot import StagedRobotConfig
from runner.config.validation import validate
from runner.robots import RobotModel
from runner.robots.mounting import mount
from runner.simulation import provenance
from runner.store.atomic import write_atomically
from runner.store.seal import read_json, sealed_json

FILE = Path("benchmarks", "dynamics.json")
TERMS = ("mass_matrix", "coriolis_matrix", "gravity", "forward_dynamics")
_STAGES = 10
_CALLS, _BLOCKS = 200, 30


def measure(outputs: Path) -> None:
    """Measure the dynamics of 3 to 30 joints unless a folder holds the measurement already; takes about a second.

    Raises:
        StoreError: if the file cannot be written.
    """
    path = outputs / FILE
    if load(path) is not None:
        return
    record = {
        "machine": provenance.machine(),
        "versions": provenance.versions(),
        "rows": [_time(model) for model in _chains()],
    }
    write_atomically(path, sealed_json(record))


def load(path: Path) -> dict[str, Any] | None:
    """Return a stored measurement, times in s by number of joints; None where there is none that can be read."""
    try:
        return read_json(path, "`runner reproduce thesis` measures it again")
    except StoreError:
        return None


def _chains() -> list[RobotModel]:
    """Return the Macro, the Macro with a Mini on it, one with a Mini on that, and so on."""
    config = validate(compose(("robot=combined",)))
    if not isinstance(config.robot, StagedRobotConfig):
        raise TypeError("robot=combined has stages")
    place = config.robot.stages["mini"].mount
    assert place is not None  # noqa: S101 - it has one
    macro, mini = (stage.urdf for stage in config.arm.stages)
    whole, tip, models = macro, "tip", [RobotModel(macro, "tip")]
    for stage in range(2, _STAGES + 1):
        prefix = f"stage{stage}_"
        whole, _ = mount(whole, mini, prefix, place.model_copy(update={"frame": tip}))
        tip = f"{prefix}tip"
        models.append(RobotModel(whole, tip))
    return models


def _time(model: RobotModel) -> dict[str, float]:
    """Return the shortest mean time of a call of each term, in s: the rest is what else the machine did."""
    arm, data = model.pin_model, model.pin_model.createData()
    generator = np.random.default_rng(0)
    q, dq, tau = (generator.uniform(-1.0, 1.0, model.nq) for _ in range(3))
    calls: tuple[Callable[[], object], ...] = (
        lambda: pin.crba(arm, data, q),
        lambda: pin.computeCoriolisMatrix(arm, data, q, dq),
        lambda: pin.computeGeneralizedGravity(arm, data, q),
        lambda: pin.aba(arm, data, q, dq, tau),
    )
    return {"joints": model.nq, **dict(zip(TERMS, map(_shortest, calls), strict=True))}


def _shortest(call: Callable[[], object]) -> float:
    return min(timeit.repeat(call, repeat=_BLOCKS, number=_CALLS)) / _CALLS
