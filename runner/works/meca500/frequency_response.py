"""Sinusoidal loads: amplitude and phase of the answer against the analytic ones."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_filter import AXES
from runner.controllers.admittance_response import ComplexArray, frequency_response, sampled_frequency_response
from runner.reporting.document import Curves, FloatArray, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.run_values import clock
from runner.store import Run
from runner.works.meca500.plan import FREQUENCIES, REPORTED, SINE_CASES
from runner.works.meca500.servo_compliance import servo_compliance
from runner.works.meca500.signals import displacement
from runner.works.meca500.step_response import law_of

_SETTLED = 0.6  # s, by which the transient has faded to 1e-4
_SLOW = 4.0  # Hz, below which servos give way as at rest
_SHOWN = ("x", "rotation x")


def frequency_response_section(runs: Mapping[str, Run]) -> Section:
    """Return the Bode plots, from sines fitted by least squares, with what the sampled law is to give."""
    omega = 2.0 * np.pi * np.array(FREQUENCIES)
    first = runs[f"sine/kinematic, 1 ms/{FREQUENCIES[0]}"]
    exact = frequency_response(law_of(first), omega)
    measured = {case: _responses(runs, case) for case in SINE_CASES}
    rows = [
        [
            f"{frequency:g}",
            *(_of(measured[case][index] / exact[index], 0) for case in SINE_CASES),
            *(_of(measured[case][index] / exact[index], 3) for case in SINE_CASES),
        ]
        for index, frequency in enumerate(FREQUENCIES)
    ]
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
            frequency_finding(**frequency_values(runs)),
        ),
    )


def frequency_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on the frequency response is about."""
    omega = 2.0 * np.pi * np.array(FREQUENCIES)
    law = law_of(runs[f"sine/kinematic, 1 ms/{FREQUENCIES[0]}"])
    exact, give = frequency_response(law, omega), _give(runs)
    periods = {case: REPORTED if "16.7" in case else 0.001 for case in SINE_CASES}
    expected = {case: sampled_frequency_response(law, period, omega) for case, period in periods.items()}
    expected["servo, 1 ms"] = expected["servo, 1 ms"] + give
    measured = {case: _responses(runs, case) for case in SINE_CASES}
    apart = {case: 100.0 * np.abs(measured[case] / expected[case] - 1.0) for case in SINE_CASES}
    off = {case: 100.0 * float(np.abs(measured[case] / exact - 1.0).max()) for case in SINE_CASES}
    slow = np.array(FREQUENCIES) <= _SLOW
    half = 200.0 * float(np.sin(omega[-1] * periods["kinematic, 1 ms"] / 4.0))
    return {
        "fast": Measured("distance from the sampled law at 1 ms", float(apart["kinematic, 1 ms"].max()), "%"),
        "slow": Measured("distance from the sampled law at 16.7 ms", float(apart["kinematic, 16.7 ms"].max()), "%"),
        "period": Measured("period of the real controller", 1e3 * REPORTED, "ms"),
        "off_fast": Measured("distance from the continuous law at 1 ms", off["kinematic, 1 ms"], "%"),
        "off_slow": Measured("distance from the continuous law at 16.7 ms", off["kinematic, 16.7 ms"], "%"),
        "half": Measured("what a delay of half a period makes at 1 ms", half, "%"),
        "highest": Measured("highest frequency", FREQUENCIES[-1], "Hz"),
        "samples": Measured("samples of the sine in a period of 16.7 ms", 1.0 / (REPORTED * FREQUENCIES[-1])),
        "servo": Measured("distance of servos from law and give", float(apart["servo, 1 ms"][slow].max()), "%"),
        "bound": Measured("frequency up to which servos give way as at rest", _SLOW, "Hz"),
        "most": Measured("least ratio of the give to the law's own answer at the highest frequency",
                         float((np.abs(give) / np.abs(exact[-1])).min())),
    }  # fmt: skip


def frequency_finding(
    fast: Measured,
    slow: Measured,
    period: Measured,
    off_fast: Measured,
    off_slow: Measured,
    half: Measured,
    highest: Measured,
    samples: Measured,
    servo: Measured,
    bound: Measured,
    most: Measured,
) -> Finding:
    """Return how the sampled law answers sines, on ideal joints and on servos."""
    return finding(
        "The sampled law answers as its theory says",
        f"On all six axes the kinematic plant is within {fast} of the sampled law's own frequency response at 1 ms, "
        f"and within {slow} at {period} (complex, relative). Against the continuous law it is off by up to {off_fast} "
        f"at 1 ms, where half a period of delay makes {half} at {highest}, and by up to {off_slow} at {period}, which "
        f"holds {samples} samples of that sine. Joint servos at 1 ms add the give of their springs under all six "
        f"loads, which the law knows nothing of: with it added to the law, they are within {servo} up to {bound}. At "
        f"{highest} the give is {most} times the law's own answer, or more.",
        fast < 0.01,
        slow < 0.1,
        off_fast.near(half, 0.1),
        off_slow > 5.0 * off_fast,
        samples < 4.0,
        servo < 30.0,
        most > 1.0,
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
