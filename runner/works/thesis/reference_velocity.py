"""A series of goals against a reference velocity for the Mini."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Curves, Formula, Panel, Section, Series, Table, Text
from runner.reporting.figures import columns, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.reporting.run_values import cell, clock, failures, measured, median, values
from runner.store import Run
from runner.works.thesis.plan import NOISES, REFERENCE_DURATIONS, VELOCITIES
from runner.works.thesis.studies import largest, ratio, wrist_rotations

_NOISY = {"none": "no noise", "thesis": "thesis noise"}


def reference_velocity_section(runs: Mapping[str, Run]) -> Section:
    """Return the tip's tracking error with and without reference velocity for the Mini, over t_f."""
    ours = {name: run for name, run in runs.items() if name.startswith("reference/")}
    t = np.array(REFERENCE_DURATIONS)
    lags = np.array([_lag(runs[f"reference/none/zero/{t_f}"]) for t_f in REFERENCE_DURATIONS], dtype=float)
    series = [
        Series(
            f"{velocity}, {_NOISY[noise]}",
            t,
            values((runs[f"reference/{noise}/{velocity}/{t_f}"] for t_f in REFERENCE_DURATIONS), "max_tracking_error"),
            "points_line",
            color=index,
        )
        for index, (noise, velocity) in enumerate((n, v) for v in VELOCITIES for n in NOISES)
    ]
    rows = []
    for t_f, lag in zip(REFERENCE_DURATIONS, lags, strict=True):
        cells = [f"{t_f:g}", number(float(lag)) if np.isfinite(lag) else "–"]
        for noise in NOISES:
            zero, full = (runs[f"reference/{noise}/{velocity}/{t_f}"] for velocity in VELOCITIES)
            cells += [cell(zero, "max_tracking_error"), cell(full, "max_tracking_error")]
            cells.append(ratio(median(zero, "max_tracking_error"), median(full, "max_tracking_error")))
        rows.append(cells)
    first = runs[f"reference/none/zero/{REFERENCE_DURATIONS[2]}"]
    blocks: list[Block] = [
        Text(
            "The thesis gives the Mini a series of goals. As in the lag of one arm, its tip is then behind by $2 xi "
            "slash omega_n$ times the speed of its target, seen from its own base, which turns with the wrist:"
        ),
        Formula(
            "p_d = R^T (x_d - x_E), quad max |p_d - p| = (2 xi) / omega_n max |dot(p)_d|",
            "the Mini's target is R transposed times x d minus x E; its lag is 2 xi over omega n times the target's "
            "speed",
        ),
        Table(
            "Largest axis error of the tip over 0 to $t_f$, one-way, full equations, no torque limit; the closed "
            "form is a norm, from the motion of the run without noise.",
            [
                "$t_f$ (s)",
                "closed form, zero (m)",
                "zero (m)",
                "full (m)",
                "ratio",
                "zero, thesis noise (m)",
                "full, thesis noise (m)",
                "ratio",
            ],
            rows,
            tuple(range(8)),
            origin(first),
        ),
        Curves(
            "Largest tip error with zero and full reference velocity of the Mini.",
            (Panel("", "duration (s)", "largest axis error (m)", series, y_log=True),),
            1,
            origin(first),
        ),
        _finding(runs),
        *failures(ours),
    ]
    return Section("The Mini's reference velocity", blocks)


def _target_speed(run: Run) -> tuple[float, float]:
    """Return the largest speed of the Mini's target in its own base frame, and of x_d - x_E alone, in m/s."""
    rest = columns(run.trace, "desired") - columns(run.trace, "macro_tip")
    seen = np.einsum("tji,tj->ti", wrist_rotations(run), rest)
    tick = np.diff(clock(run))[:, None]
    speeds = [np.linalg.norm(np.diff(path, axis=0) / tick, axis=1) for path in (seen, rest)]
    return (largest(speeds[0]) or float("nan")), (largest(speeds[1]) or float("nan"))


def _lag(run: Run) -> float:
    controller = run.config["controller"]
    factor = 2.0 * float(controller["damping_ratio"]["mini"]) / float(controller["natural_frequency"]["mini"])
    return factor * _target_speed(run)[0]


def _finding(runs: Mapping[str, Run]) -> Finding:
    t_f, shortest, longest = REFERENCE_DURATIONS[2], REFERENCE_DURATIONS[0], REFERENCE_DURATIONS[-1]
    (zero, full), (noisy_zero, noisy_full) = (
        [_error(runs, noise, velocity, t_f) for velocity in VELOCITIES] for noise in NOISES
    )
    quick, slow = (_error(runs, "thesis", "full", each) for each in (shortest, longest))
    turned, straight = (
        Measured(f"speed of the Mini's target, {name}", speed, "m/s")
        for name, speed in zip(
            ("from its turning base", "from the ground"), _target_speed(runs[f"reference/none/zero/{t_f}"]), strict=True
        )
    )
    return finding(
        f"The full reference is {noisy_zero / noisy_full} times better with thesis noise, {zero / full} times without",
        f"At $t_f$ = {t_f:g} s, one run each. It is the wrist's rotation that moves the target: at most {turned} seen "
        f"from the turning base against {straight} seen from the ground. With full reference the error under noise "
        f"hardly depends on $t_f$ ({quick} at {shortest:g} s, {slow} at {longest:g} s) and is {noisy_full / full} "
        "times that without noise: what is left is what the encoders of both arms leave.",
        noisy_zero > 3.0 * noisy_full,
        zero > 50.0 * full,
        turned > 10.0 * straight,
        quick.near(slow, 0.1),
        noisy_full > 10.0 * full,
    )


def _error(runs: Mapping[str, Run], noise: str, velocity: str, t_f: float) -> Measured:
    name = f"tip error, {velocity} reference, {_NOISY[noise]}, {t_f:g} s"
    return measured(runs[f"reference/{noise}/{velocity}/{t_f}"], "max_tracking_error", name)
