"""The Mini's bandwidth: what a slower Mini gains at rest and loses in motion, and what a bias leaves."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from runner.reporting.document import Block, Curves, Panel, Section, Series, Table, Text
from runner.reporting.figures import joint_columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import cell, failures, measured, values
from runner.store import Run
from runner.works.thesis.plan import BANDWIDTHS, BIASED, MACRO_BIAS

_METRICS = {"steady_state_error": "at rest", "max_tracking_error": "largest while it moves"}


def bandwidth_section(runs: Mapping[str, Run]) -> Section:
    """Return the tip's error at rest and in motion over the Mini's natural frequency, with and without a bias."""
    ours = {name: run for name, run in runs.items() if name.startswith("bandwidth/")}
    first = _run(runs, BANDWIDTHS[0])
    rows = [
        [
            f"{rate:g}",
            bias,
            cell(run, "steady_state_error"),
            cell(run, "max_tracking_error"),
            cell(run, "macro_steady_state_error"),
        ]
        for bias, rates in (("0", BANDWIDTHS), (number(MACRO_BIAS), BIASED))
        for rate in rates
        for run in [_run(runs, rate, bias != "0")]
    ]
    held = runs["bandwidth/held"]
    rows.append(["Mini held", "0", "–", "–", cell(held, "macro_steady_state_error")])
    blocks: list[Block] = [
        Text(
            "The same arm, encoders and motion (preset sound, one-way, the Mini's weight known to the Macro, "
            f"$t_f = 3$ s, thesis noise and limits, {first.record['repetitions']} repetitions), with Minis of other "
            "natural frequencies. Two of the runs add a bias, a constant error of each of the Macro's encoders."
        ),
        Table(
            "Largest axis errors, medians over the repetitions: at rest over the last half second, in motion from 0 "
            "to $t_f$.",
            [
                "$omega_n$ of the Mini (rad/s)",
                "bias of the Macro's encoders (rad)",
                "tip at rest (m)",
                "tip while it moves (m)",
                "Macro's end point at rest (m)",
            ],
            rows,
            (0, 1, 2, 3, 4),
            origin(first),
        ),
        _curves(runs),
        _finding(runs),
        *failures(ours),
    ]
    return Section("Accuracy against the Mini's bandwidth", blocks)


def at_rest(runs: Mapping[str, Run], rate: float, biased: bool = False) -> Measured:
    """Return the tip's error at rest with a Mini of a natural frequency, with or without a bias."""
    return measured(_run(runs, rate, biased), "steady_state_error", f"tip at rest, {_named(rate, biased)}")


def in_motion(runs: Mapping[str, Run], rate: float, biased: bool = False) -> Measured:
    """Return the largest tracking error of the tip, likewise."""
    return measured(_run(runs, rate, biased), "max_tracking_error", f"tip in motion, {_named(rate, biased)}")


def floor(runs: Mapping[str, Run]) -> Measured:
    """Return by how much the bias of the Macro's encoders puts the tip elsewhere at the last posture, to first order.

    The controllers bring the tip that they believe to the goal: all of the Macro's joints are off by the bias, the
    Mini's are right. The largest axis of J_M b, J_M the Macro's columns of the whole arm's tip Jacobian.
    """
    run = _run(runs, BIASED[-1], True)
    q = joint_columns(run.trace, "q")[-1]
    name = "where the bias puts the tip"
    if not np.isfinite(q).all():
        return Measured(name, None, "m")
    joints = sum(not joint.startswith("mini_") for joint in run.provenance["joints"])
    bias = float(run.config["noise"]["bias"]["macro"])
    moved = model_of(run).tip_jacobian(q)[:3, :joints] @ np.full(joints, bias)
    return Measured(name, float(np.abs(moved).max()), "m")


def _run(runs: Mapping[str, Run], rate: float, biased: bool = False) -> Run:
    return runs[f"bandwidth/bias/{rate}" if biased else f"bandwidth/{rate}"]


def _named(rate: float, biased: bool) -> str:
    return f"{rate:g} rad/s{', bias' if biased else ''}"


def _curves(runs: Mapping[str, Run]) -> Curves:
    series = []
    for index, (metric, name) in enumerate(_METRICS.items()):
        plain, biased = (
            values((_run(runs, rate, bias) for rate in rates), metric)
            for bias, rates in ((False, BANDWIDTHS), (True, BIASED))
        )
        series += [
            Series(name, np.array(BANDWIDTHS), plain, "points_line", color=2 * index),
            Series(f"{name}, with bias", np.array(BIASED), biased, "points", color=2 * index + 1),
        ]
    return Curves(
        "Error of the tip against the Mini's natural frequency.",
        (
            Panel(
                "",
                "natural frequency of the Mini (rad/s)",
                "largest axis error (m)",
                series,
                y_log=True,
            ),
        ),
        1,
        origin(_run(runs, BANDWIDTHS[0])),
    )


def _finding(runs: Mapping[str, Run]) -> Finding:
    rest, motion = ([of(runs, rate) for rate in BANDWIDTHS] for of in (at_rest, in_motion))
    fast, slow = (at_rest(runs, rate, True) for rate in BIASED)
    biased = floor(runs)
    listed = "; ".join(
        f"{quantity(rate, 'rad/s')}: {still} and {moving}"
        for rate, still, moving in zip(BANDWIDTHS, rest, motion, strict=True)
    )
    return finding(
        "A slower Mini averages the encoders' noise, and lags where it is slow enough; a bias of the encoders stays",
        f"Tip at rest and in motion, {listed}. At rest each slower Mini errs less. In motion the slowest two lag: the "
        "law is not told its target's acceleration, so that its lag goes with $1 slash omega_n^2$, and that of "
        f"{BANDWIDTHS[-1]:g} rad/s errs {motion[-1] / motion[-2]} times as much as that of {BANDWIDTHS[-2]:g} rad/s. "
        f"With a bias of {quantity(MACRO_BIAS, 'rad')} the tip rests {fast} off at {BIASED[0]:g} rad/s and {slow} at "
        f"{BIASED[-1]:g} rad/s; the bias alone puts it {biased} elsewhere.",
        *(after < 0.85 * before for before, after in pairwise(rest)),
        motion[1] < 0.9 * motion[0],
        motion[2] > 1.2 * motion[1],
        (motion[3] / motion[2]).near((BANDWIDTHS[2] / BANDWIDTHS[3]) ** 2, 0.2),
        slow.near(biased, 0.15),
        fast > biased,
        slow > 5.0 * rest[-1],
    )
