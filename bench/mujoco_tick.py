"""CPU time of a control tick on MuJoCo, against only MuJoCo's own step and read calls.

Both are on the same arm under the same torques, with the arms and first laws of bench/arms.py, in turns.
"""

from collections.abc import Callable
from statistics import median

import mujoco

from bench.arms import ARMS, Arm, assembled
from bench.tick import whole_run
from bench.tip_loop import FloatArray
from bench.turns import Block, kept_of, measure, ratio
from runner.assembly.closed_loop import ClosedLoop
from runner.plants.mujoco import Mujoco
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_encoders

TICKS = 2000
ROUNDS = 20
_MOST = {1: 1.8, 10: 1.35}  # of MuJoCo's own time, by steps in a tick


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: Number of rounds; None for ROUNDS.
    """
    print(f"CPU time of a control tick on MuJoCo; medians of {kept_of(rounds or ROUNDS)}")
    met = [_measured(arm, rounds or ROUNDS) for arm in ARMS]
    return all(met)


def _measured(arm: Arm, rounds: int) -> bool:
    law, blocks = next(iter(arm.laws)), dict[str, Block]()
    cases = [(integrator, steps) for integrator in ("euler", "rk4") for steps in _MOST]
    for integrator, steps in cases:
        config, closed = assembled(arm, law, "mujoco", steps, TICKS, f"plant.integrator={integrator}")
        torques = simulate(closed, make_encoders(closed, config.noise, config.settings.seed, 0)).tau[:-1]
        blocks[f"own {integrator} {steps}"] = Block(_alone(closed, torques), TICKS)
        blocks[f"ours {integrator} {steps}"] = Block(whole_run(config, closed), TICKS)
    times, met = measure(blocks, rounds), True
    print(f"  {arm.name}, {law}")
    for integrator, steps in cases:
        own, ours = times[f"own {integrator} {steps}"], times[f"ours {integrator} {steps}"]
        share, most = ratio(ours, own), _MOST[steps]
        met &= share <= most
        print(
            f"    {integrator:13} {steps:2} steps  {median(ours):7.2f} us, MuJoCo itself {median(own):7.2f} us: "
            f"{share:5.2f}  at most {most:g}: {'met' if share <= most else 'MISSED'}"
        )
    return met


def _alone(closed: ClosedLoop, torques: FloatArray) -> Callable[[], None]:
    """Return a loop over the raw calls, on the plant's own model."""
    plant = closed.plant
    assert isinstance(plant, Mujoco)
    model, data, steps = plant._model, plant._data, plant._steps_per_tick
    rest = closed.q_start * 0.0

    def block() -> None:
        plant.reset(closed.q_start, rest)
        for tau in torques:
            data.qfrc_applied[:] = tau
            mujoco.mj_step(model, data, steps)
            data.qpos.copy(), data.qvel.copy()

    return block
