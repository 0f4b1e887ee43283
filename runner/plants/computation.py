"""Computation delay, jitter and missed commands in a control loop."""

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, NonNegativeInt, model_validator

from runner.base.errors import ConfigError, nearest
from runner.schema.model import StrictModel

Probability = Annotated[float, Field(ge=0.0, le=1.0)]
Rows = NDArray[np.int64]

_SUM = 1e-9  # by which the sum of probabilities may miss 1


class ComputationConfig(StrictModel):
    """Config of what happens between a law's torque and the joints.

    Attributes:
        delay: Ticks of the fastest loop from a command until it acts; one number, or one for each control loop.
        jitter: Probabilities that a command comes 0, 1, 2, ... such ticks later still; None for none. Where a later
            one overtakes, the newest command acts.
        miss: Probability that a command is not ready in time and dropped, so that the one before goes on acting; or a
            pattern of 0 and 1 over a loop's own ticks, repeated, in which 1 is a miss. None for none.
    """

    delay: NonNegativeInt | dict[str, NonNegativeInt]
    jitter: list[Probability] | None
    miss: Probability | list[Annotated[int, Field(ge=0, le=1)]] | None

    @model_validator(mode="after")
    def _check_shares(self) -> "ComputationConfig":
        if self.jitter is not None and abs(sum(self.jitter) - 1.0) > _SUM:
            raise ValueError(
                f"jitter: probabilities must add up to 1; found {self.jitter}, {sum(self.jitter):g} in all"
            )
        if isinstance(self.miss, list) and all(self.miss):
            raise ValueError(f"miss: a pattern needs a 0, a tick that is not missed; found {self.miss}")
        return self

    @property
    def is_even(self) -> bool:
        """Whether every command acts, all as late."""
        return not self.jitter and not self.misses

    @property
    def misses(self) -> bool:
        """Whether commands are dropped."""
        return bool(self.miss) if not isinstance(self.miss, list) else any(self.miss)

    def by_loop(self, loops: Sequence[str]) -> list[int]:
        """Return the delay of each loop, in ticks of the fastest one.

        Raises:
            ConfigError: for a mapping that names other loops.
        """
        if not isinstance(self.delay, Mapping):
            return [self.delay] * len(loops)
        known, key = ", ".join(loops), "plant.computation.delay"
        problems = [
            f"{key}.{name}: no such loop{nearest(name, loops)}; loops: {known}"
            for name in self.delay
            if name not in loops
        ]
        problems += [f"{key}.{name}: missing; loops: {known}" for name in loops if name not in self.delay]
        if problems:
            raise ConfigError(problems)
        return [self.delay[name] for name in loops]

    def arrivals(self, delay: int, every: int, ticks: int, generator: np.random.Generator) -> Rows:
        """Return the tick whose command acts in each tick, shape (ticks,); the first acts from the start.

        Args:
            delay: Of the loop, in ticks.
            every: Ticks between two commands of the loop.
            ticks: Number of ticks.
            generator: Source of the draws, which are made for all commands whatever becomes of them.
        """
        made = np.arange(0, ticks, every)
        late, lost = np.zeros(len(made), dtype=np.int64), np.zeros(len(made), dtype=bool)
        if self.jitter is not None:
            late = generator.choice(len(self.jitter), size=len(made), p=np.array(self.jitter) / sum(self.jitter))
        if isinstance(self.miss, list):
            lost = np.resize(np.array(self.miss, dtype=bool), len(made))
        elif self.miss is not None:
            lost = generator.random(len(made)) < self.miss
        comes = made + delay + late
        acts = np.zeros(ticks, dtype=np.int64)
        there = ~lost & (comes < ticks)
        np.maximum.at(acts, comes[there], made[there])
        return np.asarray(np.maximum.accumulate(acts))


EXACT = ComputationConfig(delay=0, jitter=None, miss=None)
"""Every command acts in the tick in which it is asked for."""
