"""Distance of whole runs by compiled code from the same runs through Pinocchio: every torque law on three arms.

Twenty seeds each, the first second, with encoder noise and torque limits, on plant=rk4; the largest difference of a
joint position is judged. Motions keep away from singular configurations, where any two roundings part.
"""

from unittest.mock import patch

import numpy as np

from runner.assembly.compiled import commands
from runner.assembly.validation import validate
from runner.base.trace import Trace
from runner.config.compose.compose import compose
from runner.simulation.run import simulate_repetition
from tools.laws import ARM_LAWS

_SEEDS = 20
_TARGET = 1e-11  # rad
_NOISY = ("plant=rk4", "trajectory=quintic", "duration=1", "noise=thesis", "torque_limits=thesis")
_ARMATURE = "robot.armature=assumed"  # light joints without it are unstable under gains of diag M
_CASES = {
    "3 joints": ("robot=macro", ARM_LAWS),
    "6 joints": ("robot=combined", ("whole_body", "macro_mini")),
    "7 joints": ("robot=xarm7", ARM_LAWS),
}


def main() -> bool:
    """Measure and print; return whether every target is met."""
    print(f"largest difference of a joint position between compiled and Pinocchio's runs, {_SEEDS} seeds, rad")
    met = []
    for arm, (robot, laws) in _CASES.items():
        for law in laws:
            limits = ("noise.position=1e-5", "torque_limits.max=40", _ARMATURE) if robot == "robot=xarm7" else ()
            largest = max(
                _apart(robot, f"controller={law}", *_NOISY, *limits, f"seed={seed}") for seed in range(_SEEDS)
            )
            met.append(largest <= _TARGET)
            print(f"  {arm}, {law:20} {largest:8.1e}  target {_TARGET:g}: {'met' if met[-1] else 'MISSED'}")
    return all(met)


def _apart(*overrides: str) -> float:
    ours = _run(*overrides)
    with patch.object(commands, "evaluator", dict):
        theirs = _run(*overrides)
    assert ours.failure is theirs.failure is None
    return float(np.abs(ours.q - theirs.q).max())


def _run(*overrides: str) -> Trace:
    own = {text.partition("=")[0]: text for text in overrides}
    config = validate(compose(list(own.values())))
    return simulate_repetition(config)
