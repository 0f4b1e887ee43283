"""Calibration procedure protocol: repetitions, estimates and errors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from runner.base.arrays import FloatArray


@dataclass(frozen=True)
class Outcome:
    """Result of one repetition.

    Attributes:
        estimates: In the order of the procedure's `estimates`, shape (m,).
        errors: Estimate less truth, in the order of its `errors`, shape (n,).
        covariance: Covariance of the errors by the calibration, shape (n, n).
        measures: Values of its `measures` by name.
        messages: Messages for the user.
    """

    estimates: FloatArray
    errors: FloatArray
    covariance: FloatArray
    measures: Mapping[str, float]
    messages: Sequence[str] = ()


class Procedure(Protocol):
    """One way to calibrate.

    Attributes:
        estimates: Unit of each estimate by name.
        errors: Unit of each error by name.
        measures: Unit of each measure of the poses, or of the result, by name.
        truth: True values of the estimates, shape (m,).
        postures: True joint positions in which the arm is read, shape (N, nq), in rad.
    """

    estimates: ClassVar[Mapping[str, str]]
    errors: ClassVar[Mapping[str, str]]
    measures: ClassVar[Mapping[str, str]]
    truth: FloatArray
    postures: FloatArray

    def repeat(self, generator: np.random.Generator) -> Outcome:
        """Calibrate once, with noise from a generator.

        Raises:
            ConfigError: if the postures leave something unknown.
        """
        ...
