"""Two-way coupling: why the Mini stretches to its limit, and when it does not."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Condition, Measured
from runner.reporting.quantities import above_rounding, number
from runner.reporting.run_values import cell, clock, failures
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.thesis.left_out_gravity import missing_acceleration
from runner.works.thesis.plan import STRETCHING
from runner.works.thesis.studies import extension, rest_of_way

_SETTLED = 1e-3  # m, of the tip error, from where on the drift is measured
_LONGEST = 0.5  # s, over which it is measured, before the reach is lost


def stretch_section(runs: Mapping[str, Run]) -> Section:
    """Return the Mini's stretch over time under two-way coupling, and the drift that makes it."""
    ours = {name: run for name, run in runs.items() if name.startswith("stretch/")}
    reach = float(runs["stretch/sound"].config["controller"]["reach"])
    rows = []
    for case in STRETCHING:
        run = runs[f"stretch/{case}"]
        window, lost = _window(run, reach), _lost(run, reach)
        missing = None if window is None else missing_acceleration(run, sum(window) // 2)
        predicted = None if missing is None else missing / _damping(run)
        rows.append(
            [
                in_words(case),
                above_rounding(missing),
                above_rounding(predicted),
                above_rounding(None if window is None else _drift(run, window)),
                "never" if lost is None else f"{lost:.2f}",
                cell(run, "steady_state_error"),
            ]
        )
    blocks: list[Block] = [
        Text(
            "With two-way coupling the Macro's target is $x_d - R p$: wherever the Mini stands is where the Macro "
            "is told to leave it. Once the tip is at the goal the Macro sees no error, whatever the Mini had to do "
            "for it, and nothing in its law holds up a weight that its model leaves out. It sinks at the speed at "
            "which its damping bears that weight, and the Mini stretches to keep the tip in place:"
        ),
        Formula(
            "v = abs(J hat(M)^(-1) (G - hat(G))) / k_v, quad k_v = 2 xi omega_n",
            "drift speed equals the acceleration of J times M inverse times the gravity left out, over k v",
        ),
        Table(
            f"Goal position with two-way coupling over {number(float(clock(runs['stretch/sound'])[-1]))} s, no "
            "noise: the acceleration left out, the drift it predicts, and the drift measured over the last "
            f"{_LONGEST:g} s before the target is out of the reach of {reach:g} m for good.",
            [
                "case",
                "left out (m/s²)",
                "predicted (m/s)",
                "measured (m/s)",
                "out of reach from (s)",
                "steady error (m)",
            ],
            rows,
            (1, 2, 3, 4, 5),
            origin(runs["stretch/sound"]),
        ),
        _goal_curves(runs, reach),
        _quintic_curves(runs, reach),
        _finding(runs, reach),
        *failures(ours),
    ]
    return Section("Two-way coupling stretches the Mini", blocks)


def _damping(run: Run) -> float:
    """Return the Macro's k_v, in 1/s."""
    controller = run.config["controller"]
    return 2.0 * float(controller["damping_ratio"]["macro"]) * float(controller["natural_frequency"]["macro"])


def _lost(run: Run, reach: float) -> float | None:
    """Return the time from which on the target is out of reach, in s; None where it is not at the end."""
    beyond = rest_of_way(run) > reach
    if run.status == "failed" or not beyond[-1]:
        return None
    inside = np.flatnonzero(~beyond)
    return float(clock(run)[inside[-1] + 1]) if len(inside) else 0.0


def _window(run: Run, reach: float) -> tuple[int, int] | None:
    """Return first and last row of the time over which the drift is measured; None where the tip never rests."""
    if run.status == "failed":
        return None
    t, lost = clock(run), _lost(run, reach)
    good = (np.linalg.norm(columns(run.trace, "error"), axis=1) < _SETTLED) & (t <= (t[-1] if lost is None else lost))
    resting = t[good]
    if not len(resting):
        return None
    first = int(np.searchsorted(t, max(resting[0], resting[-1] - _LONGEST)))
    last = int(np.searchsorted(t, resting[-1]))
    return (first, last) if last > first else None


def _drift(run: Run, window: tuple[int, int]) -> float:
    """Return the mean speed of the Macro's end point while the tip rests at the goal, in m/s."""
    (first, last), t, moved = window, clock(run), columns(run.trace, "macro_tip")
    return float(np.linalg.norm(moved[last] - moved[first]) / (t[last] - t[first]))


def _goal_curves(runs: Mapping[str, Run], reach: float) -> Curves:
    series = [
        Series(in_words(case), clock(runs[f"stretch/{case}"]), rest_of_way(runs[f"stretch/{case}"]))
        for case in STRETCHING
    ]
    t = clock(runs["stretch/sound"])
    series.append(Series("reach", t, np.full(len(t), reach), "dotted"))
    panel = Panel(
        "", "time (s)", "distance to the target (m)", series, x_range=(1.0, float(t[-1])), y_range=(0.05, 0.3)
    )
    return Curves(
        "Goal position: distance $|x_d - x_E|$ from the Macro's end point to the goal, which the Mini has to bridge.",
        (panel,),
        1,
        origin(runs["stretch/sound"]),
    )


def _quintic_curves(runs: Mapping[str, Run], reach: float) -> Curves:
    panels = []
    for title, measure in (("Distance to the target |x_d − x_E|", rest_of_way), ("Stretch of the Mini |p|", extension)):
        series = [
            Series(
                in_words(preset), clock(runs[f"stretch/quintic/{preset}"]), measure(runs[f"stretch/quintic/{preset}"])
            )
            for preset in PRESETS
        ]
        t = clock(runs["stretch/quintic/sound"])
        series.append(Series("reach", t, np.full(len(t), reach), "dotted"))
        panels.append(Panel(title, "time (s)", "distance (m)", series))
    return Curves(
        "Tracking with two-way coupling. Beyond its reach the Mini holds its posture.",
        panels,
        2,
        origin(runs["stretch/quintic/sound"]),
    )


def _finding(runs: Mapping[str, Run], reach: float) -> Finding:
    lost = {
        case: Measured(f"out of reach for good from ({in_words(case)})", _lost(runs[f"stretch/{case}"], reach), "s")
        for case in _SINKING
    }
    end = float(clock(runs["stretch/sound"])[-1])
    left = {case: _way_left(runs[f"stretch/{case}"], case) for case in STRETCHING if case not in _SINKING}
    shares = {
        preset: Measured(
            f"share of the trajectory out of reach ({in_words(preset)})",
            100.0 * float(np.mean(rest_of_way(runs[f"stretch/quintic/{preset}"]) > reach)),
            "%",
        )
        for preset in PRESETS
    }
    bound = Measured("reach", reach, "m")
    return finding(
        "A weight that the Macro's law leaves out stretches the Mini",
        f"The goal is lost for good after {lost['sound']} with the full equations and after {lost['as_reported']} as "
        "reported; until then the Macro sinks at the predicted speed. As reported the gravity term alone makes the "
        "difference. With the full equations it is the Mini's own weight, which the Macro's model does not know: "
        f"told of it, or on the decoupled plant, the Mini keeps within reach over the {number(end)} s. On the quintic "
        f"trajectory the target is out of reach for {shares['sound']} (full equations) and {shares['as_reported']} (as "
        f"reported) of the run; the reach is {bound}.",
        *(time < 0.9 * end for time in lost.values()),
        *(way < 0.95 * bound for way in left.values()),
        *_as_predicted(runs, reach),
        *(share > 10.0 for share in shares.values()),
    )


_SINKING = ("sound", "as_reported")


def _way_left(run: Run, case: str) -> Measured:
    """Return the distance from the Macro's end point to the goal at the end of a run."""
    whole = run.status != "failed"
    return Measured(f"way left at the end ({in_words(case)})", float(rest_of_way(run)[-1]) if whole else None, "m")


def _as_predicted(runs: Mapping[str, Run], reach: float) -> list[Condition]:
    """Return the conditions that the Macro sinks at the speed at which its damping bears what its law leaves out."""
    conditions = []
    for case in _SINKING:
        run = runs[f"stretch/{case}"]
        window = _window(run, reach)
        drift = None if window is None else _drift(run, window)
        speed = None if window is None else missing_acceleration(run, sum(window) // 2) / _damping(run)
        measured, predicted = (
            Measured(f"drift ({in_words(case)})", drift, "m/s"),
            Measured(f"predicted ({in_words(case)})", speed, "m/s"),
        )
        conditions.append(measured.near(predicted, 0.2))
    return conditions
