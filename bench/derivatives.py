"""Derivatives of a run by all its parameters, against the run: both only as compiled code."""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from runner.analysis import GROUPS
from runner.analysis.sensitivity import slopes_of
from runner.assembly.compiled.loop_program import run_all, tangents
from runner.config.compose.compose import compose

RUNS = {
    "macro": ("robot=macro", "plant=rk4", "trajectory=quintic", "noise=thesis"),
    "xarm7": ("robot=xarm7", "controller=operational_space", "plant=rk4", "trajectory=quintic", "noise=thesis"),
}
TARGET = {"macro": 2.0, "xarm7": 4.0}
"""Times of a run that a derivative by one parameter may take."""
TURNS = 15


def main(rounds: int | None = None) -> bool:
    """Print the cost of derivatives in runs; return whether the targets are met.

    Args:
        rounds: Number of rounds; None for TURNS.
    """
    met, turns = True, rounds or TURNS
    for name, overrides in RUNS.items():
        found = slopes_of(compose(overrides), GROUPS, 0)
        config, loop_program, setting, slopes = (
            found.scene.config,
            found.scene.loop_program,
            found.scene.setting,
            found.settings,
        )
        times = np.arange(config.timing.ticks + 1) * config.timing.tick
        shared, errors = (
            loop_program.commands.shared(times, config.path.sample(times)),
            [e[None] for e in setting.errors],
        )
        loop = partial(run_all, loop_program, loop_program.values[None], shared, errors, setting.start[None])
        run = _best(loop, turns)
        all_ = _best(partial(tangents, loop_program, setting, slopes, shared), turns)
        each = all_ / run / len(slopes)
        good = each <= TARGET[name]
        met &= good
        print(
            f"{name}: {len(slopes)} parameters in {1e3 * all_:.2f} ms, {all_ / run:.1f} runs of {1e3 * run:.2f} ms; "
            f"{each:.2f} runs each, target {TARGET[name]:g}: {'met' if good else 'MISSED'}"
        )
    return met


def _best(work: Callable[[], object], rounds: int) -> float:
    work()
    found = []
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        found.append(time.perf_counter() - began)
    return min(found)
