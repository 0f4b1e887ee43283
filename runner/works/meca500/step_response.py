"""Steady pushes: the answer of each axis against the analytic one."""

from collections.abc import Mapping

import numpy as np

from runner.controllers.admittance_filter import AXES, Admittance
from runner.controllers.admittance_response import step_response
from runner.reporting.document import Curves, FloatArray, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import clock
from runner.store import Run
from runner.works.meca500.plan import REPORTED, STEP_CASES
from runner.works.meca500.servo_compliance import kept_stiffness, servo_compliance
from runner.works.meca500.signals import displacement

_CHOSEN = ("kinematic, 1 ms", "kinematic, 16.7 ms", "servo, 1 ms", "servo, 16.7 ms")


def law_of(run: Run) -> Admittance:
    """Return the law of a run's axes."""
    controller = run.config["controller"]
    return Admittance(*(np.array(controller[key]) for key in ("mass", "damping", "stiffness")))


def step_response_section(runs: Mapping[str, Run]) -> Section:
    """Return the six step responses, on joints that go where they are told and on servos, at 1 ms and at 16.7 ms."""
    errors = {(case, axis): step_error(runs[f"step/{case}/{axis}"], axis) for case in STEP_CASES for axis in AXES}
    rows = []
    for axis in AXES:
        _, answer, _ = _answers(runs[f"step/kinematic, 1 ms/{axis}"], axis)
        unit = "mm" if AXES.index(axis) < 3 else "mrad"
        cells = [_percent(errors[case, axis]) for case in STEP_CASES]
        rows.append([axis, quantity(1e3 * float(np.abs(answer).max()), unit), *cells, _percent(_give(runs, axis))])
    law = law_of(runs["step/kinematic, 1 ms/x"])
    force = max(runs["step/kinematic, 1 ms/x"].config["environment"]["force"])
    moment = max(runs["step/kinematic, 1 ms/rotation x"].config["environment"]["moment"])
    return Section(
        "Step response of each axis",
        (
            Text(
                f"A force of {force:g} N, or a moment of {moment:g} N m, sets in at rest, on one axis at a time. The "
                f"law has $M = {law.mass[0]:g}$ kg, $B = {law.damping[0]:g}$ N s/m, $K = {law.stiffness[0]:g}$ N/m "
                f"along the axes and $M = {law.mass[3]:g}$ kg m², $B = {law.damping[3]:g}$ N m s/rad, "
                f"$K = {law.stiffness[3]:g}$ N m/rad about them: critically damped at 20 rad/s. The answer is held "
                "against"
            ),
            Formula(
                "x(t) = f / K (1 - e^(-a t) (1 + a t)), quad a = B / (2 M)",
                "x of t equals f over K times one minus e to the minus a t times one plus a t, with a equal B over 2 M",
                "8",
            ),
            _curves(runs),
            Table(
                "Largest distance from the analytic answer, in per cent of its peak. Answers are joined by straight "
                "lines between ticks.",
                ["axis", "peak", *STEP_CASES, "give of the servos at 1 ms"],
                rows,
                tuple(range(1, 8)),
                origin(runs["step/kinematic, 1 ms/x"]),
            ),
            ideal_step_finding(**ideal_step_values(runs)),
            Text(
                "Servos at joints with mass give way to the load, by their springs. They evaluate spring and damper at "
                "the end of their period $h$, which no stiffness makes unstable, and which leaves of the springs' "
                "stiffness $K_s$ against a load that they do not know of only $K_e$. So much the tool moves:"
            ),
            Formula(
                "C f = J K_e^(-1) J^T f, quad K_e = M (M + h D + h^2 K_s)^(-1) K_s",
                "C f equals J times the inverse of K e times J transposed times f, with K e equal M times the inverse "
                "of M plus h D plus h squared K s, times K s",
            ),
            servo_step_finding(**servo_step_values(runs)),
        ),
    )


def ideal_step_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on joints that go where they are told is about."""
    worst = {case: _worst(runs, case) for case in STEP_CASES}
    sampled = max(_error_at_ticks(runs[f"step/kinematic, 16.7 ms/{axis}"], axis) for axis in AXES)
    return {
        "fast": Measured("largest error at 1 ms", worst["kinematic, 1 ms"], "%"),
        "period": Measured("period of the real controller", 1e3 * REPORTED, "ms"),
        "slow": Measured("largest error at 16.7 ms", worst["kinematic, 16.7 ms"], "%"),
        "ticks": Measured("largest error at the ticks of 16.7 ms", 100.0 * sampled, "%"),
        "late": Measured(
            "largest error at 16.7 ms of a load just after a tick", worst["kinematic, 16.7 ms, felt late"], "%"
        ),
    }


def ideal_step_finding(fast: Measured, period: Measured, slow: Measured, ticks: Measured, late: Measured) -> Finding:
    """Return how far the answer to a push is from that of a mass on a damper and a spring, on ideal joints."""
    return finding(
        "On every axis the answer is that of a mass on a damper and a spring",
        f"On the kinematic plant it is within {fast} of the peak at 1 ms, on every axis. At the real controller's "
        f"{period} it is within {ticks} at the ticks; the straight lines between are off by {slow} of the peak, "
        f"and a load that sets in just after a tick is felt a period late, which makes it {late}.",
        fast < 0.01,
        slow < 2.0,
        ticks < 0.05,
        late > 5.0 * slow,
        late < 20.0,
    )


def servo_step_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on servos is about."""
    gives = {axis: 100.0 * _give(runs, axis) for axis in AXES}
    errors = {axis: 100.0 * step_error(runs[f"step/servo, 1 ms/{axis}"], axis) for axis in AXES}
    run = runs["step/servo, 1 ms/x"]
    period = float(run.config["plant"]["servo"]["period"])
    return {
        "fast": Measured("largest error on servos at 1 ms", max(errors.values()), "%"),
        "give": Measured("largest give of the servos by the closed form", max(gives.values()), "%"),
        "apart": Measured(
            "largest distance of error and give on an axis", max(abs(errors[a] - gives[a]) for a in AXES), "%"
        ),
        "slow": Measured("largest error on servos at 16.7 ms", _worst(runs, "servo, 16.7 ms"), "%"),
        "kept": Measured("stiffness that the last joint keeps", 100.0 * float(kept_stiffness(run, period)[-1]), "%"),
        "shorter": Measured(
            "stiffness that it keeps with a tenth of the period",
            100.0 * float(kept_stiffness(run, 0.1 * period)[-1]),
            "%",
        ),
    }


def servo_step_finding(
    fast: Measured, give: Measured, apart: Measured, slow: Measured, kept: Measured, shorter: Measured
) -> Finding:
    """Return that servos give way by their springs."""
    return finding(
        "What the servos add is their springs' give",
        f"At 1 ms they are off by {fast} of the peak on the worst axis, where the closed form of their give has "
        f"{give}; on no axis do the two part by more than {apart} of the peak. At 16.7 ms they are off by {slow}. The "
        f"last joint bears so little inertia that it keeps {kept} of its stiffness; with a tenth of "
        f"plant.servo.period it keeps {shorter}.",
        fast.near(give, 0.1),
        apart < 2.0,
        slow < 40.0,
        kept < 10.0,
        shorter > 5.0 * kept,
    )


def _worst(runs: Mapping[str, Run], case: str) -> float:
    return 100.0 * max(step_error(runs[f"step/{case}/{axis}"], axis) for axis in AXES)


def _error_at_ticks(run: Run, axis: str) -> float:
    """Return the largest distance from the analytic answer at the ticks, as a share of its peak."""
    index = AXES.index(axis)
    loads = np.array([*run.config["environment"]["force"], *run.config["environment"]["moment"]])
    since = np.maximum(clock(run) - float(run.config["environment"]["begin"]), 0.0)
    expected = step_response(law_of(run), loads, since)[:, index]
    return float(np.abs(displacement(run)[:, index] - expected).max() / np.abs(expected).max())


def _answers(run: Run, axis: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return fine times, the run's answer joined by straight lines, and the analytic one, in s and m or rad."""
    index = AXES.index(axis)
    loads = np.array([*run.config["environment"]["force"], *run.config["environment"]["moment"]])
    times = np.linspace(0.0, clock(run)[-1], 3001)
    answer = np.interp(times, clock(run), displacement(run)[:, index])
    since = np.maximum(times - float(run.config["environment"]["begin"]), 0.0)
    return times, answer, step_response(law_of(run), loads, since)[:, index]


def _give(runs: Mapping[str, Run], axis: str) -> float:
    """Return how far servos at 1 ms give way to the push at rest, as a share of the law's own answer."""
    run, index = runs[f"step/servo, 1 ms/{axis}"], AXES.index(axis)
    return float(servo_compliance(run)[index, index] * law_of(run).stiffness[index])


def step_error(run: Run, axis: str) -> float:
    """Return the largest distance of a step response from the analytic one, as a share of its peak."""
    _, answer, expected = _answers(run, axis)
    return float(np.abs(answer - expected).max() / np.abs(expected).max())


def _percent(share: float) -> str:
    return f"{number(100.0 * share, 2)} %"


def _curves(runs: Mapping[str, Run]) -> Curves:
    panels = []
    for axis in AXES:
        unit = "mm" if AXES.index(axis) < 3 else "mrad"
        times, _, expected = _answers(runs[f"step/kinematic, 1 ms/{axis}"], axis)
        begin = float(runs[f"step/kinematic, 1 ms/{axis}"].config["environment"]["begin"])
        series = [Series("analytic", times - begin, 1e3 * expected, "dashed")]
        for case in _CHOSEN:
            run = runs[f"step/{case}/{axis}"]
            since = clock(run) - float(run.config["environment"]["begin"])
            answer = 1e3 * displacement(run)[:, AXES.index(axis)]
            series.append(Series(case, since, answer, "points" if case == "kinematic, 16.7 ms" else "line"))
        panels.append(Panel(axis, "time since the push (s)", f"displacement ({unit})", series, x_range=(-0.02, 0.4)))
    return Curves(
        "Answers of the six axes to a steady push.", panels, 2, origin(runs["step/kinematic, 1 ms/x"], "(8), steps")
    )
