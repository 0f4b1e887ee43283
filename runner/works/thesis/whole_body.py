"""Method 1, the whole arm under one law, against method 3, at equal rates."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, clock, failures, measured, median
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.thesis.plan import COMPARED_RATES, SLOW_DURATION, TIP_SPEEDS
from runner.works.thesis.studies import settled

_METHOD_3 = tuple(rate for rate in COMPARED_RATES if not rate.startswith("whole body"))
_SLOW_3 = "one_way, both 10 ms"
_FAST_3 = tuple(rate for rate in _METHOD_3 if rate != _SLOW_3)
_SHOWN = ("whole body, 1 ms", "one_way, 10 ms and 1 ms", "two_way, 10 ms and 1 ms")


def whole_body_section(runs: Mapping[str, Run]) -> Section:
    """Return goal and tracking under methods 1 and 3 at 1 ms and 10 ms, and method 1 with limited tip speed."""
    ours = {name: run for name, run in runs.items() if name.startswith("whole_body/")}
    rows = []
    for rate in COMPARED_RATES:
        goal, track = (runs[f"whole_body/{motion}/{rate}"] for motion in ("goal", "quintic"))
        rows.append(
            [
                in_words(rate),
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
    slow = runs[f"whole_body/goal/{_SLOW_3}"]
    rate_mini, period_mini = (float(slow.config["controller"][key]["mini"]) for key in ("natural_frequency", "period"))
    blocks: list[Block] = [
        Text(
            "The thesis holds method 1 to be unrealizable: its dynamics take too long, and the arm is redundant. "
            "What the dynamics cost is measured below; the redundancy is what a dynamically "
            "consistent null space is for: the Mini's joints stay near home as far as the task lets them. Both "
            "methods here with thesis noise and limits, the full equations, the coupled arm, medians of "
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


def _rates(runs: Mapping[str, Run]) -> Finding:
    fast, slow = (_tracking(runs, f"whole body, {rate}") for rate in ("1 ms", "10 ms"))
    fast_3 = [_tracking(runs, rate) for rate in _FAST_3]
    slow_3 = _tracking(runs, _SLOW_3)
    longer = measured(
        runs["whole_body/slow"], "max_tracking_error", f"tip error, whole body, 10 ms, {SLOW_DURATION:g} s"
    )
    failed = runs["whole_body/goal/whole body, 10 ms"].status == "failed"
    listed = "; ".join(f"{error} ({in_words(rate)})" for error, rate in zip(fast_3, _FAST_3, strict=True))
    return finding(
        "On the trajectory method 1 tracks better than method 3 at both rates; at the slow one its goal move diverges",
        f"At 1 ms the tip error of method 1 is {fast}. The variants of method 3 that were tried with a Mini at 1 ms "
        f"have: {listed}. With all loops at 10 ms it is {slow} (method 1) against {slow_3} (method 3). Given "
        f"{SLOW_DURATION:g} s for the same path (a single run) method 1 at 10 ms does not gain: {longer}. On the goal "
        "move at 10 ms it diverges.",
        *(fast < 0.7 * error for error in fast_3),
        slow < 0.7 * slow_3,
        longer > 0.7 * slow,
        Measured("goal moves of method 1 at 10 ms that diverge", float(failed)) >= 1.0,
    )


def _tracking(runs: Mapping[str, Run], rate: str) -> Measured:
    return measured(runs[f"whole_body/quintic/{rate}"], "max_tracking_error", f"tip error, {in_words(rate)}")


def _curves(runs: Mapping[str, Run]) -> Curves:
    shown = [(in_words(rate), runs[f"whole_body/goal/{rate}"]) for rate in _SHOWN]
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


def _speeds(runs: Mapping[str, Run]) -> Finding:
    best, other = fastest_speed(runs), fastest_method_3(runs)
    free = runs["whole_body/goal/whole body, 1 ms"]
    limited = None if best is None else runs[f"whole_body/speed/{best[0]}"]
    variant = None if other is None else runs[f"whole_body/goal/{other[0]}"]
    ours = Measured("settling time of method 1, speed limited", None if best is None else best[1], "s")
    theirs = Measured("settling time of the fastest method 3 tried", None if other is None else other[1], "s")
    unlimited = measured(free, "settling_time", "settling time of method 1, no speed limit")
    latest = _extreme(limited, "max", "latest settling of method 1, speed limited")
    earliest = _extreme(variant, "min", "earliest settling of the fastest method 3 tried")
    at_limit = _share(free, "ticks at a torque limit, no speed limit")
    spared = _share(limited, "ticks at a torque limit, speed limited")
    return finding(
        f"With a largest tip speed method 1 is faster than the {len(_METHOD_3)} variants of method 3 that were tried",
        f"With {quantity(None if best is None else best[0], 'm/s')} the goal move settles after {ours} (at most "
        f"{latest} in {free.record['repetitions']} repetitions), without limit after {unlimited}; the fastest variant "
        f"of method 3 that was tried ({'–' if other is None else in_words(other[0])}) takes {theirs} (at least "
        f"{earliest}). Without the limit some joint is at its torque limit for {at_limit} of the ticks, with it for "
        f"{spared}: a goal two metres away asks for more than the joints have, and the saturated law asks for less.",
        ours < 0.8 * theirs,
        latest < 0.9 * earliest,
        ours < 0.95 * unlimited,
        spared < 0.75 * at_limit,
    )


def _extreme(run: Run | None, which: str, name: str) -> Measured:
    stored = None if run is None else run.metrics.get("settling_time")
    return Measured(name, None if stored is None else stored[which], "s")


def _share(run: Run | None, name: str) -> Measured:
    share = None if run is None else median(run, "saturation_fraction")
    return Measured(name, None if share is None else 100.0 * share, "%")
