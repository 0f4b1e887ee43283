"""Computation delay of control loops, and its checks."""

from collections.abc import Sequence

from runner.base.errors import ConfigError
from runner.config.run import RunConfig
from runner.controllers import Loop
from runner.plants import PlantConfig
from runner.plants.computation import EXACT, ComputationConfig
from runner.plants.kinds import ComputesLate

_MAX_TICKS = 10_000_000


def computation_of(plant: PlantConfig) -> ComputationConfig:
    """Return what happens between laws and joints; a plant whose config has no such key takes commands at once."""
    return plant.computation if isinstance(plant, ComputesLate) else EXACT


def count_late(plant: PlantConfig, loops: Sequence[Loop]) -> tuple[int, ...]:
    """Return how late the commands of each loop act, in ticks of the fastest one, without jitter.

    Raises:
        ConfigError: for a mapping that names other loops, or a delay that is longer than any run.
    """
    late = computation_of(plant).by_loop([loop.name for loop in loops])
    if max(late) > _MAX_TICKS:
        raise ConfigError([f"plant.computation.delay: {max(late)} ticks found; allowed: up to {_MAX_TICKS}"])
    return tuple(late)


def check_computation(config: RunConfig) -> None:
    """Check that commands that come unevenly are torques, and that a pattern of misses fits into the run.

    Raises:
        ConfigError: where they are not, or it does not.
    """
    computation, timing, key = computation_of(config.plant), config.timing, "plant.computation"
    if computation.is_even:
        return
    problems = []
    if config.commands != "torque":
        problems.append(
            f"{key}: {config.controller.kind} commands joint positions, which come all as late; take jitter=null and "
            "miss=null, or a controller that gives torques"
        )
    for loop in config.loops if isinstance(computation.miss, list) else ():
        own, pattern = timing.ticks // round(loop.period / timing.tick) + 1, computation.miss
        assert isinstance(pattern, list)  # noqa: S101 - as above
        if len(pattern) > own:
            problems.append(
                f"{key}.miss: a pattern of {len(pattern)} ticks, and the loop {loop.name} has {own} in the run; take a "
                "shorter one, or a longer duration"
            )
    if problems:
        raise ConfigError(problems)
