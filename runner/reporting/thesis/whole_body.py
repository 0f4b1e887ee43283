"""Method 1, the whole arm under one law, against method 3, at equal rates."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Notice, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, clock, failures, median
from runner.reporting.thesis.combined_plan import COMPARED_RATES, SLOW_DURATION, TIP_SPEEDS
from runner.reporting.thesis.studies import settled
from runner.store import Run

_METHOD_3 = tuple(rate for rate in COMPARED_RATES if not rate.startswith("whole body"))
_SHOWN = ("whole body, 1 ms", "one_way, 10 ms and 1 ms", "two_way, 10 ms and 1 ms")


def whole_body_section(runs: Mapping[str, Run]) -> Section:
    """Return goal and tracking under methods 1 and 3 at 1 ms and 10 ms, and method 1 with limited tip speed."""
    ours = {name: run for name, run in runs.items() if name.startswith("whole_body/")}
    rows = []
    for rate in COMPARED_RATES:
        goal, track = (runs[f"whole_body/{motion}/{rate}"] for motion in ("goal", "quintic"))
        rows.append(
            [
                rate,
                settled(goal),
                cell(goal, "steady_state_error"),
                cell(goal, "saturation_fraction"),
                cell(track, "max_tracking_error"),
                cell(track, "steady_state_error"),
            ]
        )
    speeds = [
        [f"{speed:g}", settled(run), cell(run, "overshoot"), cell(run, "saturation_fraction")]
        for speed in TIP_SPEEDS
        for run in [runs[f"whole_body/speed/{speed}"]]
    ]
    slow = runs["whole_body/goal/one_way, both 10 ms"]
    rate_mini, period_mini = (float(slow.config["controller"][key]["mini"]) for key in ("natural_frequency", "period"))
    blocks: list[Block] = [
        Text(
            "The thesis holds method 1 to be unrealizable: its dynamics take too long, and the arm is redundant. "
            "The first is no longer true, as the cost of the dynamics shows, the second is what a dynamically "
            "consistent null space is for: the Mini's joints stay near home as far as the task lets them. Both "
            "methods here with thesis noise and limits, preset sound, the coupled arm, medians of "
            f"{slow.record['repetitions']} repetitions. At 10 ms the Mini's loop keeps its $omega_n h$, "
            f"{number(rate_mini * period_mini)}, so that its $omega_n$ falls to {number(rate_mini)} rad/s."
        ),
        Table(
            "Methods 1 and 3. Two periods are those of Macro and Mini.",
            [
                "method, period",
                "goal: settles (s)",
                "steady error (m)",
                "ticks at a limit",
                "tracking: largest error (m)",
                "steady error (m)",
            ],
            rows,
            (1, 2, 3, 4, 5),
            origin(runs["whole_body/goal/whole body, 1 ms"]),
        ),
        _rates(runs),
        Table(
            "Whole body at 1 ms on the goal move, F* saturated at a largest tip speed (Khatib's $V_max$).",
            ["largest tip speed (m/s)", "settles (s)", "overshoot (m)", "ticks at a limit"],
            speeds,
            (0, 1, 2, 3),
            origin(runs[f"whole_body/speed/{TIP_SPEEDS[0]}"]),
        ),
        _curves(runs),
        _speeds(runs),
        *failures(ours),
    ]
    return Section("The whole body under one law", blocks)


def fastest_speed(runs: Mapping[str, Run]) -> tuple[float, float] | None:
    """Return the largest tip speed whose goal move settles first, in m/s, and its settling time, in s."""
    times = {speed: median(runs[f"whole_body/speed/{speed}"], "settling_time") for speed in TIP_SPEEDS}
    known = {speed: time for speed, time in times.items() if time is not None}
    best = min(known, key=lambda speed: known[speed]) if known else None
    return None if best is None else (best, known[best])


def fastest_method_3(runs: Mapping[str, Run]) -> tuple[str, float] | None:
    """Return the variant of method 3 whose goal move settles first, and its settling time, in s."""
    times = {rate: median(runs[f"whole_body/goal/{rate}"], "settling_time") for rate in _METHOD_3}
    known = {rate: time for rate, time in times.items() if time is not None}
    best = min(known, key=lambda rate: known[rate]) if known else None
    return None if best is None else (best, known[best])


def _rates(runs: Mapping[str, Run]) -> Notice:
    def better(first: str, second: str) -> str:
        a, b = (median(runs[f"whole_body/quintic/{rate}"], "max_tracking_error") for rate in (first, second))
        if a is None or b is None:
            return f"{first} or {second} fails"
        words = "tracks better than" if a < b else "tracks worse than"
        return f"{first} {words} {second} ({quantity(a, 'm')} against {quantity(b, 'm')})"

    slow, fast = (
        median(runs[f"whole_body/quintic/whole body, {rate}"], "max_tracking_error") for rate in ("10 ms", "1 ms")
    )
    worse = fast is not None and (slow is None or slow > 10.0 * fast)
    return Notice(
        "finding",
        "Method 1 needs the fast rate" if worse else "Method 1 does with the slow rate",
        f"{better('whole body, 1 ms', 'one_way, 10 ms and 1 ms')}; "
        f"{better('whole body, 10 ms', 'one_way, both 10 ms')}. " + _slower(runs, slow),
    )


def _slower(runs: Mapping[str, Run], fast: float | None) -> str:
    """Return whether more time for the same path helps method 1 at 10 ms."""
    error = median(runs["whole_body/slow"], "max_tracking_error")
    if error is None:
        return f"Given {SLOW_DURATION:g} s for the same path method 1 still fails at 10 ms."
    if fast is not None and error > 0.1 * fast:
        return f"Given {SLOW_DURATION:g} s for the same path method 1 at 10 ms still misses by {quantity(error, 'm')}."
    return (
        f"Given {SLOW_DURATION:g} s for the same path method 1 at 10 ms misses by {quantity(error, 'm')} only: it is "
        "the fast turn of joint 1 beside the base axis, during which a torque held for 10 ms no longer fits the "
        "posture at its end. In method 3 the Mini makes up for what the Macro misses there."
    )


def _curves(runs: Mapping[str, Run]) -> Curves:
    shown = [(rate, runs[f"whole_body/goal/{rate}"]) for rate in _SHOWN]
    best = fastest_speed(runs)
    if best is not None:
        shown.append((f"whole body, {best[0]:g} m/s", runs[f"whole_body/speed/{best[0]}"]))
    series = []
    for name, run in shown:
        t, error = clock(run), np.linalg.norm(columns(run.trace, "error"), axis=1)
        series.append(Series(name, t[t <= 2.5], error[t <= 2.5]))
    return Curves(
        "Goal move: distance of the tip from the goal, repetition 0.",
        (Panel("", "time (s)", "distance (m)", series),),
        1,
        origin(runs["whole_body/goal/whole body, 1 ms"]),
    )


def _speeds(runs: Mapping[str, Run]) -> Notice:
    best, other = fastest_speed(runs), fastest_method_3(runs)
    if best is None or other is None:
        return Notice("warning", "No comparison of the fastest", "A method does not settle at all.")
    free = median(runs["whole_body/goal/whole body, 1 ms"], "settling_time")
    faster = best[1] < other[1]
    return Notice(
        "finding",
        f"With a largest tip speed method 1 is {'faster' if faster else 'no faster'} than any variant of method 3",
        f"With {best[0]:g} m/s the goal move settles after {quantity(best[1], 's')}, without limit after "
        f"{quantity(free, 's')}; the fastest variant of method 3 ({other[0]}) takes {quantity(other[1], 's')}. A "
        "goal two metres away asks for far more than the joints have; the saturated law asks for what they have.",
    )
