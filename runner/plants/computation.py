"""Computation delay, jitter and missed commands in a control loop."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, NonNegativeInt, model_validator

from runner.schema.model import StrictModel
from runner.schema.values import by_name

Probability = Annotated[float, Field(ge=0.0, le=1.0)]
Rows = NDArray[np.int64]

_SUM = 1e-9  # tolerance of the sum of probabilities


class ComputationConfig(StrictModel):
    """Config of delay, jitter and misses between a controller's torque and the joints.

    Attributes:
        delay: Ticks of the fastest loop from a command until it acts; one number, or one for each control loop.
        jitter: Probabilities that a command arrives 0, 1, 2, ... ticks later than `delay`; None for no jitter. If a
            later command overtakes an earlier one, the newest command acts.
        miss: Probability that a command is not ready in time and is dropped, so that the previous command continues to
            act; or a pattern of 0 and 1 over a loop's ticks, repeated, in which 1 is a miss. None for no misses.
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
        """True if every command acts, all with the same delay."""
        return not self.jitter and not self.misses

    @property
    def misses(self) -> bool:
        """True if commands are dropped."""
        return bool(self.miss) if not isinstance(self.miss, list) else any(self.miss)

    def by_loop(self, loops: Sequence[str]) -> list[int]:
        """Return the delay of each loop, in ticks of the fastest loop.

        Raises:
            ConfigError: if a mapping names unknown loops or lacks a loop.
        """
        if isinstance(self.delay, dict):
            return by_name("plant.computation.delay", self.delay, loops, "loop")
        return [self.delay] * len(loops)

    def arrivals(self, delay: int, every: int, ticks: int, generator: np.random.Generator) -> Rows:
        """Return the tick whose command acts in each tick, shape (ticks,); the first command acts from the start.

        Args:
            delay: Delay of the loop, in ticks.
            every: Ticks between two commands of the loop.
            ticks: Number of ticks.
            generator: Source of the random draws; they are drawn for all commands, even dropped ones.
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
"""Computation without delay: every command acts in the tick in which it is computed."""
