"""Reference solutions of the runs, Runge-Kutta by Pinocchio, and computing times of both Runge-Kutta versions.

No config selects the solutions or Runge-Kutta by Pinocchio. They are computed once and stored in a file next to the
runs.
"""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from runner import store
from runner.assembly.assemble import assemble
from runner.assembly.closed_loop import ClosedLoop
from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.assembly.versions import versions
from runner.base.atomic import write_atomically
from runner.base.errors import StoreError
from runner.base.machine import this_machine
from runner.base.trace import Trace
from runner.config.compose.compose import compose
from runner.papers.studies.precision.exact import AdaptiveStep, Collocation, energy_drift
from runner.papers.study.grids import FILE as RUNS
from runner.papers.study.grids import Grids
from runner.plants import Plant
from runner.plants.rk4 import Rk4
from runner.robots.model import RobotModel
from runner.simulation.loop import simulate
from runner.simulation.run import simulate_repetition
from runner.simulation.sensors import make_encoders
from runner.store.seal import read_json, sealed_json

FILE = Path("benchmarks", "precision.json")
PLANT = "Runge-Kutta"
"""The plant whose runs the solutions belong to: same law, same ticks."""
_TIMES = 5  # that a compiled run is timed
_FINEST, _COARSER = 1e-15, 1e-12  # tolerances; SciPy takes 2e-14 for the relative part of the first


class Interpreted(Rk4):
    """The Runge-Kutta plant with Pinocchio's accelerations, as used where nothing can be compiled."""

    def __init__(self, model: RobotModel, step: float, steps_per_tick: int) -> None:
        super().__init__(model, step, steps_per_tick)
        self._compiled = None


def measure(outputs: Path) -> None:
    """Compute the solutions, in a few seconds, unless a folder holds those of the same runs.

    Raises:
        StoreError: if the file cannot be written.
    """
    path = outputs / FILE
    cases: dict[str, dict[str, RunConfig]] = {}
    grids = Grids(Path(__file__).parent / RUNS)
    for name, overrides in grids.runs.items():
        case, arm, plant, step = (text for _, text in grids.parts[name])
        if plant == PLANT:
            cases.setdefault(f"{case}/{arm}", {})[step] = validate(compose(overrides))
    hashes = {
        f"{case}/{PLANT}/{step}": store.run_hash(config.resolved, config.arm.urdf)
        for case, steps in cases.items()
        for step, config in steps.items()
    }
    known = load(path)
    if known is not None and known["runs"] == hashes:
        return
    record = {
        "machine": this_machine().record(),
        "versions": versions(),
        "runs": hashes,
        "cases": {case: _solved(steps) for case, steps in cases.items()},
    }
    write_atomically(path, sealed_json(record))


def load(path: Path) -> dict[str, Any] | None:
    """Return the content of a folder; None if it cannot be read."""
    try:
        return read_json(path, "`runner reproduce precision` makes it again")
    except StoreError:
        return None


def _solved(steps: Mapping[str, RunConfig]) -> dict[str, Any]:
    """Return the solution of a case, how far other ways to it are, and Runge-Kutta by Pinocchio, by steps."""
    config = next(iter(steps.values()))
    closed, model, tick = assemble(config), config.arm.model, config.timing.tick
    exact = _simulated(config, closed, AdaptiveStep(model, tick, _FINEST))
    others = {
        "tolerance": _simulated(config, closed, AdaptiveStep(model, tick, _COARSER)),
        "collocation": _simulated(config, closed, Collocation(model, tick)),
    }
    return {
        "q": exact.q.tolist(),
        "tip": exact.tip.tolist(),
        "apart": {name: float(np.abs(other.q - exact.q).max()) for name, other in others.items()},
        "energy": None if exact.tau.any() else energy_drift(model, exact.q, exact.dq),
        "compiled_seconds": {step: _compiled_seconds(own) for step, own in steps.items()},
        "interpreted": {step: _interpreted(own, exact) for step, own in steps.items()},
    }


def _interpreted(config: RunConfig, exact: Trace) -> dict[str, float]:
    """Return the errors of Runge-Kutta by Pinocchio from a solution, in rad and m, and its time, in s."""
    plant = Interpreted(config.arm.model, config.timing.step, config.timing.steps_per_tick)
    trace = _simulated(config, assemble(config), plant)
    return {
        "joints": float(np.abs(trace.q - exact.q).max()),
        "tip": float(np.linalg.norm(trace.tip - exact.tip, axis=1).max()),
        "seconds": float(np.median(trace.tick_seconds)) * config.timing.ticks,
    }


def _compiled_seconds(config: RunConfig) -> float:
    """Return the shortest time that a compiled run took, in s: the first one loads the code."""
    runs = [simulate_repetition(config) for _ in range(_TIMES)]
    return min(float(np.median(trace.tick_seconds)) for trace in runs) * config.timing.ticks


def _simulated(config: RunConfig, closed: ClosedLoop, plant: Plant) -> Trace:
    """Return a run with another plant and no compiled code."""
    encoders = make_encoders(closed, config.noise, config.settings.seed, 0)
    return simulate(replace(closed, plant=plant, compiled=None), encoders)
