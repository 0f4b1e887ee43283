"""The straight path past the base axis, and how the tracking error depends on the time allowed for it."""

from collections.abc import Mapping

import numpy as np

from runner.claims import load_claims
from runner.reporting.document import Curves, Notice, Panel, Picture, Section, Series, Text
from runner.reporting.drawings import top_view
from runner.reporting.figures import columns, model_of, origin
from runner.reporting.job import PRESETS
from runner.reporting.quantities import number
from runner.reporting.thesis.plan import DURATIONS, TORQUE_DURATIONS, TRACKED
from runner.store import Run


def base_axis_section(runs: Mapping[str, Run]) -> Section:
    """Return joint 1 at its limit where the path passes the base axis."""
    run = runs["base_axis"]
    trace, model = run.trace, model_of(run)
    t = trace["t"].to_numpy()
    desired, tip = columns(trace, "desired"), columns(trace, "tip")
    shoulder = model.shoulder[:2]
    distance = np.linalg.norm(desired[:, :2] - shoulder, axis=1)
    limit = run.config["torque_limits"]["max"]
    pinned = t[np.abs(trace["tau1"].to_numpy()) >= limit * (1.0 - 1e-12)]
    error = columns(trace, "error")
    free = runs[f"base_axis/{DURATIONS[3]}"]
    singular = runs["singular"].failure or {}
    peaks = np.array([runs[f"base_axis/{t_f}"].metrics["peak_torque_q1"]["median"] for t_f in TORQUE_DURATIONS])
    return Section(
        "Past the base axis",
        (
            Text(
                f"The straight line from home to the goal passes the base axis at {_closest(desired, shoulder):.4f} "
                "m. There joint 1 has to turn the arm by nearly half a turn in a moment."
            ),
            Picture(
                "The path seen from above, with the torque limit of 50 N m and without noise.",
                top_view(model, tip, desired),
                "Path of the tip seen from above, passing the base axis",
                0.7,
                origin(run),
            ),
            Curves(
                f"Noise-free tracking, $t_f = 3$ s. Joint 1 stands at its limit from {pinned[0]:.2f} to "
                f"{pinned[-1]:.2f} s ({len(pinned)} ticks); without limit it would take "
                f"{number(free.metrics['peak_torque_q1']['median'])} N m.",
                (
                    Panel(
                        "Distance to the base axis",
                        "time (s)",
                        "distance (m)",
                        (
                            Series("desired", t, distance, "dashed"),
                            Series("actual", t, np.linalg.norm(tip[:, :2] - shoulder, axis=1)),
                        ),
                    ),
                    Panel(
                        "Torque of joint 1",
                        "time (s)",
                        "torque (N m)",
                        (
                            Series("limit 50 N m", t, trace["tau1"].to_numpy(), color=1),
                            Series(
                                "no limit", free.trace["t"].to_numpy(), free.trace["tau1"].to_numpy(), "dashed", color=0
                            ),
                        ),
                    ),
                    Panel(
                        "Tip error",
                        "time (s)",
                        "error (m)",
                        [Series(axis, t, error[:, i]) for i, axis in enumerate("xyz")],
                    ),
                    Panel(
                        "Peak torque of joint 1, no limit",
                        "duration (s)",
                        "torque (N m)",
                        (
                            Series("peak torque", np.array(TORQUE_DURATIONS), peaks, "points_line"),
                            Series("50 N m", np.array(TORQUE_DURATIONS), np.full(len(peaks), 50.0), "dotted"),
                        ),
                        y_log=True,
                    ),
                ),
                2,
                origin(run),
            ),
            Notice(
                "finding",
                "Why claim 3 holds for any controller",
                "Joint 1 keeps within 50 N m only from $t_f = 3.86$ s on (PyBullet at 1 ms; 3.87 s on the "
                "Runge-Kutta plant). Below, the error near the axis is set by the torque limit, not by the law: "
                "both presets give 0.10 m.",
            ),
            Notice(
                "finding",
                "Without a limit the goal move diverges",
                "The goal move runs to within $10^(-5)$ m of the base axis. Under the law as printed, sampled at 10 "
                f"ms and without a torque limit, it diverges at t = {number(singular.get('time'))} s (joint "
                f"{singular.get('joint')}). The torque limit hides this. Outside this report the runner therefore "
                "damps the inverse of J near singular postures (controller.singularity_damping).",
            ),
        ),
    )


def _closest(path: np.ndarray, point: np.ndarray) -> float:
    """Return the distance of a straight path, given by its end rows, to a vertical axis."""
    start, end = path[0, :2], path[-1, :2]
    along = end - start
    share = np.clip((point - start) @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(start + share * along - point))


def duration_section(runs: Mapping[str, Run]) -> Section:
    """Return the largest tracking error against the duration of the motion, beside the printed values."""
    printed = {claim.experiment.rpartition("/")[2]: claim.printed for claim in load_claims("thesis")}
    t = np.array(DURATIONS)
    panels = []
    for figure, title in zip(TRACKED, ("Limit of 50 N m (claim 3)", "No torque limit (claim 4)"), strict=True):
        series = [Series(preset, t, _errors(runs, figure, preset), "points_line") for preset in PRESETS]
        low, high = printed[figure]
        series.append(
            Series(
                "printed range",
                t,
                np.full(len(t), high),
                "dotted",
                low=np.full(len(t), low),
                high=np.full(len(t), high),
            )
        )
        panels.append(Panel(title, "duration (s)", "largest axis error (m)", series, y_log=True))
    free = _errors(runs, "figure_3_10", "as_reported")
    limited = _errors(runs, "figure_3_9", "as_reported")
    needed = [
        float(np.interp(-printed[figure][1], -errors, t))
        for figure, errors in (("figure_3_10", free), ("figure_3_9", limited))
    ]
    return Section(
        "Tracking error against duration",
        (
            Curves(
                "Largest axis error over 0 to $t_f$ (median of 5 repetitions) against $t_f$. The thesis does not "
                "print its $t_f$.",
                panels,
                2,
                origin(runs[f"figure_3_9/as_reported/{DURATIONS[0]}"]),
            ),
            Text(
                "No single duration meets every number: with preset as_reported the largest printed error without "
                f"limit, {printed['figure_3_10'][1]:g} m, asks for $t_f = {needed[0]:.1f}$ s, the largest with "
                f"limit, {printed['figure_3_9'][1]:g} m, for $t_f = {needed[1]:.1f}$ s. We take 3 s throughout."
            ),
        ),
    )


def _errors(runs: Mapping[str, Run], figure: str, preset: str) -> np.ndarray:
    metrics = [runs[f"{figure}/{preset}/{t_f}"].metrics["max_tracking_error"]["median"] for t_f in DURATIONS]
    return np.array(metrics, dtype=float)
