"""Frequency response to sinusoidal loads: amplitude and phase compared with the closed form."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from runner.base.arrays import FloatArray
from runner.controllers.force.admittance_filter import AXES, Admittance, discretise
from runner.reporting.document import Panel, Series
from runner.store import Run
from runner.studies.meca500.figures import displacement, law_of, loads_of, once, servo_compliance
from runner.studies.meca500.plan import FREQUENCIES, REPORTED, SINE_CASES
from runner.study.results import Runs

ComplexArray = NDArray[np.complex128]


def step_response(law: Admittance, loads: FloatArray, times: FloatArray) -> FloatArray:
    r"""Return the displacement of each axis after a constant load sets in at rest.

    With a = B / 2M and b^2 = a^2 - K/M, real or imaginary,

    .. math:: x(t) = \frac{f}{K} \left( 1 - e^{-at} (\cosh bt + a t \frac{\sinh bt}{bt}) \right),

    and without a spring x = (f/B) (t - (1 - e^{-Bt/M}) M/B), without a damper too x = f t^2 / 2M. In m and rad.
    """
    axes = zip(law.mass, law.damping, law.stiffness, loads, strict=True)
    return np.column_stack([_step(M, B, K, f, times) for M, B, K, f in axes])


def _step(M: float, B: float, K: float, f: float, t: FloatArray) -> FloatArray:
    if K > 0.0:
        a = B / (2.0 * M)
        bt = np.emath.sqrt(a**2 - K / M) * t
        faster, slower = np.exp(-a * t - bt), np.exp(-a * t + bt)  # no factor grows beyond 1
        small = np.abs(bt) < 1e-4
        safe = np.where(small, 1.0, bt)
        sinhc = np.where(small, np.exp(-a * t) * (1.0 + bt**2 / 6.0), (slower - faster) / (2.0 * safe))
        return np.real(f / K * (1.0 - 0.5 * (slower + faster) - a * t * sinhc))
    if B > 0.0:
        return f / B * (t + np.expm1(-B * t / M) * M / B)
    return 0.5 * f * t**2 / M


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
    the law's own answer the give is at least.
    """
    omega = 2.0 * np.pi * float(run.config["environment"]["frequency"])
    law, period, found = law_of(run), float(run.config["controller"]["period"]), fitted_response(run)
    exact, sampled = (own[0] for own in (frequency_response(law, np.array([omega])),
                      sampled_frequency_response(law, period, np.array([omega]))))  # fmt: skip
    give = _give(run) if run.config["plant"]["kind"] != "kinematic" else np.zeros(len(AXES))
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
    }


def bode(runs: Runs) -> list[Panel]:
    """Return amplitude and phase along x and about x, with the laws' own."""
    servo, points = runs[f"sine/servo, 1 ms/{FREQUENCIES[0]}"], np.array(FREQUENCIES)
    fine = np.geomspace(points[0], points[-1], 200)
    exact = frequency_response(law_of(servo), 2.0 * np.pi * fine)
    sampled = sampled_frequency_response(law_of(servo), REPORTED, 2.0 * np.pi * fine)
    drawn = [
        ("analytic", fine, exact, "dashed"),
        ("sampled law, 16.7 ms", fine, sampled, "dotted"),
        ("analytic, and yielding of the servos", fine, exact + _give(servo), "dotted"),
    ]
    for case in SINE_CASES:
        found = np.array([fitted_response(runs[f"sine/{case}/{frequency}"]) for frequency in FREQUENCIES])
        drawn.append((case, points, found, "points"))
    panels = []
    for axis, unit in (("x", "m/N"), ("rotation x", "rad/(N m)")):
        index = AXES.index(axis)
        for title, label, of in (("amplitude", f"amplitude ({unit})", np.abs), ("phase", "phase (degrees)", _phase)):
            series = [Series(name, x, of(y[:, index]), style) for name, x, y, style in drawn]  # type: ignore[arg-type]
            panels.append(Panel(f"{axis}, {title}", "frequency (Hz)", label, series, True, title == "amplitude"))
    return panels


def _phase(response: ComplexArray) -> FloatArray:
    return np.degrees(np.unwrap(np.angle(response)))


def _give(run: Run) -> FloatArray:
    """Return the compliance that the servos' springs add on each axis, x / f under the loads of all, shape (6,)."""
    return servo_compliance(run) @ loads_of(run) / loads_of(run)
