"""CPU time of a control tick for every torque law and 3, 6 and 7 joints, against what no loop can go below.

- F: only PyBullet's torque, step and read calls, on the same arm under the same torques.
- L: the closed loop of the arm's first law in C++ with Pinocchio, one Runge-Kutta step in a tick; bench/least_loops.
- MuJoCo in a Python loop with its own law; bench/peers.py.

The runner's times are of whole runs: draws of the noise, the path, every tick with its guards, and the trace. All of
an arm is measured in turns. Beforehand L and the peers are checked to be the same closed loop: their tips follow the
path like the runner's.
"""

from collections.abc import Callable
from statistics import median
from typing import NamedTuple

import numpy as np

from bench import compile_times, peers
from bench.arms import ARMS, Arm, assembled
from bench.batches import batches
from bench.least_loops import MissingError, least_loop
from bench.tick import pybullet_alone, whole_run
from bench.tip_loop import FloatArray, TipLoop, tip_loop
from bench.turns import Block, kept_of, measure, ratio
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders

TICKS = 2000
ROUNDS = 20
_MOST_BATCH_L = 0.06
_SAME_TIP = 1e-5  # m, between L's tip and the runner's; redundant arms also differ in their null space
_NEAR_PATH = 2e-3  # m, from the path; a peer's tip, whose plant or law is another


class Row(NamedTuple):
    """A line of the table.

    Attributes:
        block: What is timed.
        units: Rows whose time is the unit.
        targets: Most that it may take, in the time of another row.
    """

    block: Block
    units: tuple[str, ...] = ()
    targets: dict[str, float] = {}  # noqa: RUF012 - never changed


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: Number of rounds; None for ROUNDS.
    """
    print(f"CPU time of a control tick; medians of {kept_of(rounds or ROUNDS)} of {TICKS} ticks")
    met = [_measured(arm, rounds or ROUNDS) for arm in ARMS]
    return all([*met, compile_times.main()])


def _measured(arm: Arm, rounds: int) -> bool:
    rows = {**_bounds(arm), **_ours(arm)}
    times = measure({name: row.block for name, row in rows.items()}, rounds)
    print(f"  {arm.name}")
    met = True
    for name, row in rows.items():
        told = "".join(f"{ratio(times[name], times[unit]):7.3f} {unit[0]}" for unit in row.units if unit in times)
        line = f"    {name:46} {median(times[name]):7.2f} us {told:20}"
        for other, most in row.targets.items():
            if other not in times:
                line += f"  (no {other})"
                continue
            reached = ratio(times[name], times[other]) <= most
            met &= reached
            line += f"  at most {most:g} of {other}: {'met' if reached else 'MISSED'}"
        print(line.rstrip())
    return met


def _ours(arm: Arm) -> dict[str, Row]:
    """Return rows of the runner's: every law on both plants, and batches."""
    rows: dict[str, Row] = {}
    first = next(iter(arm.laws))
    for law in arm.laws:
        for substeps, most in zip(arm.substeps, arm.most_bullet, strict=True):
            F, peer = _f(substeps), _implicitfast(substeps)
            block = Block(whole_run(*assembled(arm, law, "bullet", substeps, TICKS)), TICKS)
            rows[f"{law}, bullet, {_steps(substeps)}"] = Row(
                block, (F,), {F: most, **({peer: 1.0} if law == first else {})}
            )
        block = Block(whole_run(*assembled(arm, law, "rk4", 1, TICKS)), TICKS)
        targets = {"L": arm.most_rk4, **({_RK4: 1.0} if law == first else {})}
        rows[f"{law}, rk4"] = Row(block, (_f(1), "L"), targets)
        for size, batch in batches(arm, law).items():
            rows[f"{law}, rk4, batch of {size}"] = Row(batch, ("L",), {"L": _MOST_BATCH_L} if size == 1000 else {})
    return rows


def _bounds(arm: Arm) -> dict[str, Row]:
    """Return F, L and the peers, checked."""
    rows: dict[str, Row] = {}
    first = next(iter(arm.laws))
    config, closed = assembled(arm, first, "rk4", 1, TICKS)
    trace, loop = (
        simulate(closed, make_encoders(closed, config.noise, config.settings.seed, 0)),
        tip_loop(config, closed),
    )
    model, tip = closed.robot.model, trace.end_points[-1]
    for substeps in arm.substeps:
        bullet, on_bullet = assembled(arm, first, "bullet", substeps, TICKS)
        torques = simulate(on_bullet, make_encoders(on_bullet, bullet.noise, bullet.settings.seed, 0)).tau[:-1].tolist()
        rows[_f(substeps)] = Row(Block(pybullet_alone(bullet, torques), TICKS))
    try:
        run, log = least_loop(loop)
        _check("L", run, log, lambda q: np.abs(model.tip_positions(q) - tip).max(), _SAME_TIP)
        rows["L"] = Row(Block(run, TICKS))
    except MissingError as reason:
        print(f"  {arm.name}: no L: {reason}")
    for name, (run, log) in _peers(arm, loop).items():
        _check(name, run, log, lambda q: np.abs(model.tip_positions(q) - loop.desired[:, 0]).max(), _NEAR_PATH)
        rows[name] = Row(Block(run, TICKS), (_f(1), "L") if name == _RK4 else (_f(int(name.split()[2])),))
    return rows


def _peers(arm: Arm, loop: TipLoop) -> dict[str, tuple[Callable[[], None], FloatArray]]:
    found = {_RK4: peers.rk4_loop(loop)}
    for substeps in arm.substeps:
        found[_implicitfast(substeps)] = peers.plain_loop(loop, substeps)
        found[f"{_implicitfast(substeps)}, trimmed"] = peers.trimmed_loop(loop, substeps)
    return found


def _check(
    name: str, run: Callable[[], None], log: FloatArray, wrong: Callable[[FloatArray], float], most: float
) -> None:
    run()
    off = wrong(log[:, 0])
    assert off <= most, f"{name} is another closed loop: its tip is {off:.2g} m off"


_RK4 = "MuJoCo RK4"


def _steps(substeps: int) -> str:
    return f"{substeps} substep{'s' if substeps > 1 else ''}"


def _f(substeps: int) -> str:
    return f"F, {_steps(substeps)}"


def _implicitfast(substeps: int) -> str:
    return f"MuJoCo implicitfast, {_steps(substeps)}"
