r"""Residuals between a recording and a run, signal by signal.

The fit is from system identification (Ljung, System Identification, 2nd edition, 1999): one minus the normalised root
mean square error,

.. math:: 1 - \frac{|y - \hat y|}{|y - \bar y|},

with y the recorded and \hat y the simulated signal. It is 1 if both are equal, and 0 if the mean of the recording would
be as good an estimate.
"""

from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.recordings.columns_map import Signal


@dataclass(frozen=True)
class Residual:
    """A signal of the recording and that of the run, at the run's ticks.

    Attributes:
        signal: Which one.
        unit: Its SI unit.
        t: Times of the run, shape (T,), in s.
        recorded: Shape (T,).
        simulated: Shape (T,).
    """

    signal: Signal
    unit: str
    t: FloatArray
    recorded: FloatArray
    simulated: FloatArray

    @property
    def values(self) -> FloatArray:
        """Recorded less simulated, shape (T,)."""
        return self.recorded - self.simulated

    @property
    def mean(self) -> float:
        """Its mean: what another zero of the encoder gives, or another load."""
        return float(self.values.mean())

    @property
    def rms(self) -> float:
        """Its root mean square."""
        return float(np.sqrt(np.mean(self.values**2)))

    @property
    def largest(self) -> float:
        """Its largest magnitude."""
        return float(np.abs(self.values).max())

    @property
    def fit(self) -> float | None:
        """The fit; None of a constant signal."""
        swing = float(np.linalg.norm(self.recorded - self.recorded.mean()))
        return None if swing == 0.0 else 1.0 - float(np.linalg.norm(self.values)) / swing
