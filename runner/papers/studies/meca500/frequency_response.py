"""Frequency response to sinusoidal loads: amplitude and phase compared with the closed form."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.controllers.force.admittance_filter import AXES, Admittance, discretise
from runner.papers.studies.meca500.figures import displacement, loads_of, once, servo_compliance
from runner.papers.studies.meca500.plan import law_in
from runner.papers.study.results import Runs
from runner.store import Run

ComplexArray = NDArray[np.complex128]


def frequency_response(law: Admittance, frequencies: FloatArray) -> ComplexArray:
    """Return x / f = 1 / (M s^2 + B s + K) at s = i omega in rad/s, above 0 without a spring, shape (W, 6) (eq. 8)."""
    s = np.asarray(1j * frequencies[:, None], dtype=np.complex128)
    return 1.0 / (law.mass * s**2 + law.damping * s + law.stiffness)


def sampled_frequency_response(law: Admittance, period: float, frequencies: FloatArray) -> ComplexArray:
    """Return the frequency response of the sampled law, sample by sample, shape (W, 6).

    It is [1, 0] (z - Phi)^-1 Gamma at z = exp(i omega h); holding the load costs about half a period, h, of lag. The
    frequencies are those of frequency_response, below pi / h.
    """
    Phi, Gamma = discretise(law, period)
    z = np.exp(1j * period * frequencies)[:, None, None, None]
    return np.linalg.solve(z * np.eye(2) - Phi, Gamma[..., None])[..., 0, 0]


_SETTLED = 0.6  # s, by which the transient has faded to 1e-4


def settled() -> float:
    """Return from when on sines are fitted, in s."""
    return _SETTLED


@once
def fitted_response(run: Run) -> ComplexArray:
    """Return x / f of each axis of a run under a sine, shape (6,), in m/N and rad/(N m)."""
    environment, times = run.config["environment"], run.t
    late = times >= _SETTLED
    angle = 2.0 * np.pi * float(environment["frequency"]) * (times[late] - float(environment["start_time"]))
    basis = np.column_stack([np.sin(angle), np.cos(angle)])
    (sine, cosine), *_ = np.linalg.lstsq(basis, displacement(run)[late], rcond=None)
    return np.asarray((sine + 1j * cosine) / loads_of(run))


def sine(run: Run) -> dict[str, Any]:
    """Return the answer of a run under a sine; that of each axis over the analytic one is a string, by its name.

    In per cent: how far an axis is off_sampled, the sampled law with the give of servos where there are some, and
    off_continuous, and what a delay of half a period makes; samples that a period of the sine holds; and how many times
    the law's own answer the give is at least, and at most (widest).
    """
    omega = 2.0 * np.pi * float(run.config["environment"]["frequency"])
    law, period, found = law_in(run.config), float(run.config["controller"]["period"]), fitted_response(run)
    exact, sampled = (own[0] for own in (frequency_response(law, np.array([omega])),
                      sampled_frequency_response(law, period, np.array([omega]))))  # fmt: skip
    give = _give(run)
    told = {
        axis: f"{abs(over):.3f}, {np.degrees(np.angle(over)):+.1f}°"
        for axis, over in zip(AXES, found / exact, strict=True)
    }
    return told | {
        "off_sampled": 100.0 * float(np.abs(found / (sampled + give) - 1.0).max()),
        "off_continuous": 100.0 * float(np.abs(found / exact - 1.0).max()),
        "half": 200.0 * float(np.sin(omega * period / 4.0)),
        "samples": 2.0 * np.pi / (omega * period),
        "give": float((np.abs(give) / np.abs(exact)).min()),
        "widest_give": float((np.abs(give) / np.abs(exact)).max()),
    }


def response(axis: str, part: str) -> Callable[[Run], float]:
    """Return the amplitude in m/N or rad/(N m), or the phase in degrees, of the answer along or about an axis."""
    return lambda run: _part(fitted_response(run)[AXES.index(axis)], part)


def theory(runs: Runs, run: str, axis: str, part: str, sampled: bool = False) -> Callable[[float], float]:
    """Return the same of a run's law over the frequency in Hz, continuous or sampled, with the give of its servos."""
    law, give, index = law_in(runs[run].config), _give(runs[run]), AXES.index(axis)
    period = float(runs[run].config["controller"]["period"])

    def value(frequency: float) -> float:
        omega = np.array([2.0 * np.pi * frequency])
        own = sampled_frequency_response(law, period, omega) if sampled else frequency_response(law, omega)
        return _part(own[0, index] + give[index], part)

    return value


def _part(answer: complex, part: str) -> float:
    """Return an amplitude, or a phase in degrees from -360 to 0."""
    return float(abs(answer) if part == "amplitude" else -(-np.degrees(np.angle(answer)) % 360.0))


def _give(run: Run) -> FloatArray:
    """Return the compliance that the servos' springs add on each axis, x / f under the loads of all, shape (6,)."""
    return servo_compliance(run) @ loads_of(run) / loads_of(run)
