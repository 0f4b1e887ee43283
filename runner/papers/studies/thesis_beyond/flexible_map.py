"""Stability maps of sampled controllers on flexible joints: spectral radius of the linearized period map."""

from collections.abc import Callable, Mapping
from copy import deepcopy
from typing import Any, cast

import numpy as np

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.base.arrays import FloatArray
from runner.base.dotted_keys import put
from runner.config.composed import Composed
from runner.controllers import Controller
from runner.reporting.document import Series
from runner.store import Run

_WIDTH = 1e-6  # rad and rad/s, of the central differences


def radius(run: Run, changes: Mapping[str, Any]) -> float:
    """Return the spectral radius of the map of small motions about the start of a run over a period of its law.

    Args:
        run: A run of one loop on flexible joints.
        changes: Values instead of those of its config, by dotted key.
    """
    closed = assemble(validate(Composed(_changed(run.config, changes))))
    try:
        side, (loop,) = closed.motor_side, closed.loops
        assert side is not None  # noqa: S101 - the caller says so
        plant = side.plant
        law, on, nq = cast(Controller, loop.controller), plant.flexibility.flexible, len(closed.q_start)
        law.reset()
        still = np.zeros((3, 3))
        still[0] = closed.robot.model.tip_position(closed.q_start)
        plant.reset(closed.q_start, np.zeros(nq))
        rest = np.concatenate([plant.q, plant.theta[on], plant.dq, plant.dtheta[on]])

        def move(state: FloatArray) -> FloatArray:
            places, speeds = np.split(state, 2)
            plant.q[:], plant.dq[:] = places[:nq], speeds[:nq]
            plant.theta[:], plant.dtheta[:] = plant.q, plant.dq
            plant.theta[on], plant.dtheta[on] = places[nq:], speeds[nq:]
            q, dq = side.read()
            plant.advance(law.torque(0.0, q.copy(), dq.copy(), still) + side.damping())
            return np.concatenate([plant.q, plant.theta[on], plant.dq, plant.dtheta[on]])

        bumps = _WIDTH * np.eye(len(rest))
        slopes = np.array([move(rest + bump) - move(rest - bump) for bump in bumps]).T / (2.0 * _WIDTH)
    finally:
        closed.close()
    return float(np.abs(np.linalg.eigvals(slopes)).max())


def stable_and_not(
    run: Run, places: FloatArray, frequencies: FloatArray, changes: Callable[[float], Mapping[str, Any]]
) -> list[Series]:
    """Return the stable and the unstable points of a law: a number against the natural frequency in rad/s.

    Args:
        run: A run of one loop on flexible joints.
        places: The number's values.
        frequencies: Natural frequencies of the law, in rad/s.
        changes: What of the run's config follows from the number.
    """
    points = np.array([(place, omega) for place in places for omega in frequencies])
    grows = np.array(
        [
            radius(run, {**changes(float(place)), "controller.natural_frequency": float(omega)}) > 1.0 + _WIDTH
            for place, omega in points
        ]
    )
    return [
        Series(name, points[kind, 0], points[kind, 1], "points")
        for name, kind in (("stable", ~grows), ("unstable", grows))
    ]


def _changed(config: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a config with other values at some dotted keys."""
    changed = deepcopy(dict(config))
    for key, value in changes.items():
        put(changed, tuple(key.split(".")), value)
    return changed
