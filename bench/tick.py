"""CPU time of a control tick, against only PyBullet's own calls.

F is the least that a PyBullet plant can cost: torque, step and read of the same arm, in a plain loop, under the same
torques. What the runner adds to it is control, measurement, limits, log and tip positions. Both are measured in
turns, a block of ticks each; see bench/turns.py.
"""

import os
from collections.abc import Callable, Iterable
from statistics import median

from bench.turns import ROUNDS, Block, kept_of, measure, ratio
from runner.assembly.assemble import assemble
from runner.assembly.run_config import RunConfig
from runner.assembly.validation import validate
from runner.base.engine_output import quiet_stderr
from runner.config.compose.compose import compose
from runner.plants.bullet_engine import Bullet
from runner.simulation.batch import BatchResult, BatchSimulator
from runner.simulation.loop import ClosedLoop, simulate
from runner.simulation.sensors import make_encoders

with quiet_stderr():
    import pybullet

TICKS = 2000
_SCENE = ("trajectory=quintic", "noise=thesis")
_MACRO = ("robot=macro", "trajectory.duration=19")
_FRICTION = (
    "plant.friction.viscous=1",
    "plant.friction.coulomb=1",
    "plant.friction.asymmetry=0.3",
    "plant.friction.static=2",
    "plant.friction.stribeck_speed=0.05",
    "plant.friction.sigmoid={level: 1, steepness: 8, shift: 0.03}",
)
_CASES = {
    "bullet, 10 substeps": (*_MACRO, "plant=bullet", "plant.step=0.001"),
    "bullet, 1 substep": (*_MACRO, "plant=bullet", "plant.step=0.01"),
    "torque, 10 substeps": (*_MACRO, "plant=bullet", "plant.step=0.001", "controller=computed_torque"),
    "torque, 1 substep": (*_MACRO, "plant=bullet", "plant.step=0.01", "controller=computed_torque"),
    "rk4, 1 step": (*_MACRO, "plant=rk4", "plant.step=0.01"),
    "rk4, friction": (*_MACRO, "plant=rk4", "plant.step=0.01", *_FRICTION),
    "armature, 10 substeps": (*_MACRO, "plant=bullet", "plant.step=0.001", "robot.armature=0.5"),
    "armature, 1 substep": (*_MACRO, "plant=bullet", "plant.step=0.01", "robot.armature=0.5"),
    "combined, 4 substeps": ("robot=combined", "trajectory.duration=1", "plant=bullet", "plant.step=0.00025"),
}


def main(rounds: int | None = None) -> bool:
    """Measure and print; return whether every target is met.

    Args:
        rounds: Number of rounds; None for ROUNDS.
    """
    loops = {name: _assemble(*overrides) for name, overrides in _CASES.items()}
    blocks: dict[str, Callable[[], None]] = {}
    for name, (config, loop) in loops.items():
        if config.plant.kind == "bullet" and not config.arm.model.armature.any():
            torques = simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0)).tau[:-1].tolist()
            blocks[f"F: {name}"] = pybullet_alone(config, torques)
        blocks[name] = whole_run(config, loop)
    times = measure({name: Block(work, TICKS) for name, work in blocks.items()}, rounds or ROUNDS)

    F10, F1 = times["F: bullet, 10 substeps"], times["F: bullet, 1 substep"]
    bullet10, bullet1, torque10, torque1, rk4, rubbing, armature10, armature1, combined = (
        times[name] for name in _CASES
    )
    F6 = times["F: combined, 4 substeps"]
    print(f"CPU time of a control tick, 3 joints (combined: 6), median of {kept_of(rounds or ROUNDS)} of {TICKS} ticks")
    for name, values in times.items():
        print(f"  {name:26} {median(values):6.2f} us  (quickest round {min(values):.2f})")
    within = [
        _judge("bullet, 10 substeps / F", ratio(bullet10, F10), 0.08),
        _judge("bullet, 1 substep / F", ratio(bullet1, F1), 0.25),
        _judge("computed torque, 10 / F", ratio(torque10, F10), 0.08),
        _judge("computed torque, 1 / F", ratio(torque1, F1), 0.25),
        _judge("combined / F", ratio(combined, F6), 0.3),
        _judge("with armature / without, 10", ratio(armature10, bullet10), 4.0),
        _judge("with armature / without, 1", ratio(armature1, bullet1), 2.5),
        _judge("rk4 / F, 10 substeps", ratio(rk4, F10), 0.9),
        _judge("rk4 with friction / without", ratio(rubbing, rk4), 1.5),
    ]
    load = os.getloadavg()[0]
    if load > 1.3:
        print(
            f"  other work runs on this machine (load {load:.1f}) and slows Python more than C: repeat when it is quiet"
        )
    return all(within)


def _assemble(*overrides: str) -> tuple[RunConfig, ClosedLoop]:
    config = validate(compose([*_SCENE, *overrides]))
    loop = assemble(config)
    assert loop.ticks == TICKS
    return config, loop


def whole_run(config: RunConfig, loop: ClosedLoop) -> Callable[[], None]:
    """Return a whole run, draws of its noise included; compiled as a whole if possible."""
    batcher = BatchSimulator()
    runs = batcher.repetitions(config, range(1))
    if runs is not None:
        return lambda: _check_all(batcher.simulate(runs))

    def block() -> None:
        trace = simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
        assert trace.failure is None

    return block


def _check_all(results: Iterable[object]) -> None:
    assert all(isinstance(each, BatchResult) for each in results)


def pybullet_alone(config: RunConfig, torques: list[list[float]]) -> Callable[[], None]:
    """Return a loop over the raw calls, on a separate arm that was made as the plant makes it."""
    loop, timing = assemble(config), config.timing
    plant = Bullet(config.arm.urdf, config.arm.model, timing.step, timing.steps_per_tick)
    client, body, joints = plant._client, plant._body, plant._joints
    rest = loop.q_start * 0.0

    def block() -> None:
        plant.reset(loop.q_start, rest)
        for tau in torques:
            pybullet.setJointMotorControlArray(
                body, joints, pybullet.TORQUE_CONTROL, forces=tau, physicsClientId=client
            )
            pybullet.stepSimulation(client)
            pybullet.getJointStates(body, joints, client)

    return block


def _judge(what: str, value: float, target: float) -> bool:
    print(f"  {what:28} {value:5.2f}  target {target:g}: {'met' if value <= target else 'MISSED'}")
    return value <= target
