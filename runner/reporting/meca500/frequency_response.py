"""Sinusoidal loads: amplitude and phase of the answer against the analytic ones."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_filter import AXES
from runner.controllers.admittance_response import ComplexArray, frequency_response, sampled_frequency_response
from runner.reporting.document import Curves, FloatArray, Formula, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.meca500.plan import FREQUENCIES, REPORTED, SINE_CASES
from runner.reporting.meca500.servo_compliance import servo_compliance
from runner.reporting.meca500.signals import displacement
from runner.reporting.meca500.step_response import law_of
from runner.reporting.quantities import number
from runner.reporting.run_values import clock
from runner.store import Run

_SETTLED = 0.6  # s, by which the transient has faded to 1e-4
_SLOW = 4.0  # Hz, below which servos give way as at rest
_SHOWN = ("x", "rotation x")


def frequency_response_section(runs: Mapping[str, Run]) -> Section:
    """Return the Bode plots, from sines fitted by least squares, with what the sampled law is to give."""
    omega = 2.0 * np.pi * np.array(FREQUENCIES)
    first = runs[f"sine/kinematic, 1 ms/{FREQUENCIES[0]}"]
    exact = frequency_response(law_of(first), omega)
    measured = {case: _responses(runs, case) for case in SINE_CASES}
    sampled = {
        case: sampled_frequency_response(law_of(first), REPORTED if "16.7" in case else 0.001, omega)
        for case in SINE_CASES
    }
    rows = [
        [
            f"{frequency:g}",
            *(_of(measured[case][index] / exact[index], 0) for case in SINE_CASES),
            *(_of(measured[case][index] / exact[index], 3) for case in SINE_CASES),
        ]
        for index, frequency in enumerate(FREQUENCIES)
    ]
    sampled["servo, 1 ms"] = sampled["servo, 1 ms"] + _give(runs)
    apart = {case: float(np.abs(measured[case] / sampled[case] - 1.0).max()) for case in SINE_CASES}
    slow = np.array(FREQUENCIES) <= _SLOW
    servo = float(np.abs(measured["servo, 1 ms"] / sampled["servo, 1 ms"] - 1.0)[slow].max())
    off = {case: float(np.abs(measured[case] / exact - 1.0).max()) for case in SINE_CASES}
    return Section(
        "Frequency response",
        (
            Text(
                "A force and a moment shake the tip along and about all three axes at once, at one frequency a run; "
                f"after {_SETTLED:g} s a sine and a cosine are fitted to each axis by least squares. The analytic "
                "answer, and that of the law sampled with period $h$ as its theory has it (a load held for a period "
                "comes half a period late), are"
            ),
            Formula(
                "X / F = 1 / (M s^2 + B s + K), quad (X / F)_h = [1 thick 0] (z - Phi)^(-1) Gamma, quad z = e^(s h)",
                "X over F equals one over M s squared plus B s plus K; sampled, one zero times the inverse of z minus "
                "Phi times Gamma",
                "8",
            ),
            _bode(runs, measured),
            Table(
                "Answer over the analytic one: ratio of amplitudes, and degrees of phase, along x and about x.",
                ["Hz", *(f"x: {case}" for case in SINE_CASES), *(f"about x: {case}" for case in SINE_CASES)],
                rows,
                tuple(range(7)),
                origin(first),
            ),
            Notice(
                "finding",
                "The sampled law answers as its theory says; what is left is the half period of a held load",
                "On all six axes the kinematic plant is within "
                f"{number(apart['kinematic, 1 ms'])} of the sampled law's own frequency response at 1 ms, and within "
                f"{number(apart['kinematic, 16.7 ms'])} at {1e3 * REPORTED:g} ms (complex, relative). Against the "
                f"continuous law that is up to {_share(off['kinematic, 1 ms'])} and "
                f"{_share(off['kinematic, 16.7 ms'])}, at {FREQUENCIES[-1]:g} Hz, where a period of 16.7 ms holds "
                f"only {1.0 / (REPORTED * FREQUENCIES[-1]):.1f} samples of the sine. Joint servos at 1 ms add the give "
                "of their springs under all six loads, which the law knows nothing of: with it added to the law, they "
                f"are within {_share(servo)} up to {_SLOW:g} Hz. Above, where the law itself hardly moves, the give is "
                "most of the answer.",
            ),
        ),
    )


def _responses(runs: Mapping[str, Run], case: str) -> ComplexArray:
    """Return x / f of each axis at each frequency, shape (W, 6)."""
    responses = np.zeros((len(FREQUENCIES), len(AXES)), dtype=np.complex128)
    for row, frequency in zip(responses, FREQUENCIES, strict=True):
        row[:] = fitted_response(runs[f"sine/{case}/{frequency}"])
    return responses


def fitted_response(run: Run) -> ComplexArray:
    """Return x / f of each axis of a run under a sine, shape (6,), in m/N and rad/(N m)."""
    environment, times = run.config["environment"], clock(run)
    settled = times >= _SETTLED
    angle = 2.0 * np.pi * float(environment["frequency"]) * (times[settled] - float(environment["begin"]))
    basis = np.column_stack([np.sin(angle), np.cos(angle)])
    (sine, cosine), *_ = np.linalg.lstsq(basis, displacement(run)[settled], rcond=None)
    response: ComplexArray = (sine + 1j * cosine) / np.array([*environment["force"], *environment["moment"]])
    return response


def _give(runs: Mapping[str, Run]) -> FloatArray:
    """Return what the servos' springs add to x / f of each axis, under the loads of all, shape (6,)."""
    run = runs[f"sine/servo, 1 ms/{FREQUENCIES[0]}"]
    loads = np.array([*run.config["environment"]["force"], *run.config["environment"]["moment"]])
    added: FloatArray = servo_compliance(run) @ loads / loads
    return added


def _of(ratio: ComplexArray, axis: int) -> str:
    return f"{abs(ratio[axis]):.3f}, {np.degrees(np.angle(ratio[axis])):+.1f}°"


def _share(value: float) -> str:
    return f"{number(100.0 * value, 2)} %"


def _bode(runs: Mapping[str, Run], measured: Mapping[str, ComplexArray]) -> Curves:
    law = law_of(runs[f"sine/kinematic, 1 ms/{FREQUENCIES[0]}"])
    fine = np.geomspace(FREQUENCIES[0], FREQUENCIES[-1], 200)
    exact = frequency_response(law, 2.0 * np.pi * fine)
    slow = sampled_frequency_response(law, REPORTED, 2.0 * np.pi * fine)
    points = np.array(FREQUENCIES)
    panels = []
    for axis in _SHOWN:
        index, unit = AXES.index(axis), "m/N" if axis in "xyz" else "rad/(N m)"
        for title, of in (("amplitude", np.abs), ("phase", lambda value: np.degrees(np.unwrap(np.angle(value))))):
            series = [
                Series("analytic", fine, of(exact[:, index]), "dashed"),
                Series("sampled law, 16.7 ms", fine, of(slow[:, index]), "dotted"),
                Series("analytic, and give of the servos", fine, of((exact + _give(runs))[:, index]), "dotted"),
                *(Series(case, points, of(values[:, index]), "points") for case, values in measured.items()),
            ]
            label = f"amplitude ({unit})" if title == "amplitude" else "phase (degrees)"
            panels.append(
                Panel(f"{axis}, {title}", "frequency (Hz)", label, series, x_log=True, y_log=title == "amplitude")
            )
    return Curves(
        "Bode plot of the admittance along x and about x.",
        panels,
        2,
        origin(runs[f"sine/kinematic, 1 ms/{FREQUENCIES[0]}"], "(8), sines"),
    )
