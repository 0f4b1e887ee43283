"""Step response to constant forces, compared with the closed form."""

from collections.abc import Callable
from typing import Any

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.controllers.force.admittance_filter import AXES
from runner.reporting.document import Panel, Series
from runner.store import Run
from runner.studies.meca500.figures import added_inertia, displacement, law_of, loads_of, once, servo_compliance
from runner.studies.meca500.frequency_response import step_response
from runner.study.results import Runs

_SHOWN = ("kinematic, 1 ms", "kinematic, 16.7 ms", "servo, 1 ms", "servo, 16.7 ms")


@once
def step(run: Run) -> dict[str, Any]:
    """Return the peak as a string, and relative to it the largest distance from the analytic answer and its parts.

    error is that of the answer joined by straight lines, and error_at_ticks that only at the ticks. give is the servos'
    deflection at rest by the closed form, and beyond_give the difference between it and the error.
    """
    index, times = _pushed(run), np.linspace(0.0, run.t[-1], 3001)
    answer = displacement(run)[:, index]
    joined = np.interp(times, run.t, answer)
    expected, at_ticks = (_expected(run, own) for own in (times, run.t))
    error = float(np.abs(joined - expected).max() / np.abs(expected).max())
    servos = run.config["plant"]["kind"] != "kinematic"
    give = float(servo_compliance(run)[index, index] * law_of(run).stiffness[index]) if servos else 0.0
    return {
        "peak": quantity(1e3 * float(np.abs(joined).max()), "mm" if index < 3 else "mrad"),
        "error": error,
        "error_at_ticks": float(np.abs(answer - at_ticks).max() / np.abs(at_ticks).max()),
        "give": give,
        "beyond_give": abs(error - give),
    }


def kept(shorter: float) -> Callable[[Run], float]:
    """Return the stiffness that the last servo keeps, in per cent, with a period `shorter` times as long."""

    def share(run: Run) -> float:
        inertia = np.diagonal(run.model.mass_matrix(run.joints("q")[0]))
        return float((100.0 * inertia / (inertia + added_inertia(run, shorter)))[-1])

    return share


def answers(runs: Runs) -> list[Panel]:
    """Return the answers of the six axes, with the analytic ones."""
    panels = []
    for index, axis in enumerate(AXES):
        found = {case: runs[f"step/{case}/{axis}"] for case in _SHOWN}
        begins = {case: float(run.config["environment"]["start_time"]) for case, run in found.items()}
        first, begin = found[_SHOWN[0]], begins[_SHOWN[0]]
        times = np.linspace(0.0, first.t[-1], 3001)
        series = [Series("analytic", times - begin, 1e3 * _expected(first, times), "dashed")]
        for case, run in found.items():
            moved = 1e3 * displacement(run)[:, index]
            style = "points" if case == "kinematic, 16.7 ms" else "line"  # a line would hide the others
            series.append(Series(case, run.t - begins[case], moved, style))  # type: ignore[arg-type]
        label = f"displacement ({'mm' if index < 3 else 'mrad'})"
        panels.append(Panel(axis, "time since the push (s)", label, series, x_range=(-0.02, 0.4)))
    return panels


def _pushed(run: Run) -> int:
    return int(np.flatnonzero(loads_of(run))[0])


def _expected(run: Run, times: FloatArray) -> FloatArray:
    since = np.maximum(times - float(run.config["environment"]["start_time"]), 0.0)
    answer: FloatArray = step_response(law_of(run), loads_of(run), since)
    return answer[:, _pushed(run)]
