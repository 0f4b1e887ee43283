"""The straight path past the base axis, and how the tracking error depends on the time allowed for it."""

from collections.abc import Mapping

import numpy as np

from runner.claims import load_claims
from runner.reporting.document import Curves, FloatArray, Panel, Picture, Section, Series, Text
from runner.reporting.drawings import top_view
from runner.reporting.figures import columns, model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.job import PRESETS
from runner.reporting.measured import Measured
from runner.reporting.quantities import number, quantity
from runner.reporting.run_values import measured, values
from runner.reporting.words import PRESET
from runner.store import Run
from runner.works.thesis.plan import DURATIONS, TORQUE_DURATIONS, TRACKED


def base_axis_section(runs: Mapping[str, Run]) -> Section:
    """Return joint 1 at its limit where the path passes the base axis."""
    run = runs["base_axis"]
    trace, model = run.trace, model_of(run)
    t = trace["t"].to_numpy()
    desired, tip = columns(trace, "desired"), columns(trace, "tip")
    shoulder = model.shoulder[:2]
    distance = np.linalg.norm(desired[:, :2] - shoulder, axis=1)
    limit = Measured("torque limit of joint 1", float(run.config["torque_limits"]["max"]), "N m")
    error = columns(trace, "error")
    duration = quantity(float(run.config["trajectory"]["duration"]), "s")
    free = runs[f"base_axis/{DURATIONS[3]}"]
    peaks = values((runs[f"base_axis/{t_f}"] for t_f in TORQUE_DURATIONS), "peak_torque_q1")
    return Section(
        "Past the base axis",
        (
            Text(
                "The straight line from home to the goal passes near the base axis. There joint 1 has to turn the arm "
                "by nearly half a turn in a moment."
            ),
            Picture(
                f"The path seen from above, with the torque limit of {limit} and without noise.",
                top_view(model, tip, desired),
                "Path of the tip seen from above, passing the base axis",
                0.7,
                origin(run),
            ),
            Curves(
                f"Noise-free tracking, $t_f$ = {duration}.",
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
                            Series(f"limit {limit}", t, trace["tau1"].to_numpy(), color=1),
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
                            Series(str(limit), np.array(TORQUE_DURATIONS), np.full(len(peaks), limit.value), "dotted"),
                        ),
                        y_log=True,
                    ),
                ),
                2,
                origin(run),
            ),
            _nearer(runs),
            _limited(runs, limit),
            _unlimited(runs),
        ),
    )


def _nearer(runs: Mapping[str, Run]) -> Finding:
    run, free = runs["base_axis"], runs[f"base_axis/{DURATIONS[3]}"]
    path = Measured("the path passes at", _passes(run, "desired"), "m")
    limited = Measured("the tip passes at, with torque limit", _passes(run, "tip"), "m")
    unlimited = Measured("the tip passes at, without torque limit", _passes(free, "tip"), "m")
    return finding(
        "At its torque limit the arm leaves the path",
        f"The path passes the base axis at {quantity(path.value, 'm', 4)}. With the torque limit the tip passes at "
        f"{quantity(limited.value, 'm', 4)}, the distance that is drawn above, and without it at "
        f"{quantity(unlimited.value, 'm', 4)}.",
        limited < 0.98 * path,
        unlimited.near(path, 0.01),
    )


def _limited(runs: Mapping[str, Run], limit: Measured) -> Finding:
    run = runs["base_axis"]
    t, torque = run.trace["t"].to_numpy(), run.trace["tau1"].to_numpy()
    pinned = t[np.abs(torque) >= float(run.config["torque_limits"]["max"]) * (1.0 - 1e-12)]
    ticks = Measured("ticks of joint 1 at its limit", float(len(pinned)))
    span = [Measured(name, float(pinned[end]) if len(pinned) else None, "s") for name, end in (("from", 0), ("to", -1))]
    peaks = {
        t_f: measured(runs[f"base_axis/{t_f}"], "peak_torque_q1", f"peak torque of joint 1, no limit, {t_f:g} s")
        for t_f in TORQUE_DURATIONS
    }
    same, short, long = DURATIONS[3], DURATIONS[4], DURATIONS[5]
    (reported, sound), (free_reported, free_sound) = (
        [measured(runs[f"{figure}/{p}"], "max_tracking_error", f"largest error, {name} ({PRESET[p]})") for p in PRESETS]
        for figure, name in zip(TRACKED, ("torque limit", "no limit"), strict=True)
    )
    return finding(
        "Why claim 3 holds under both presets: the torque limit sets the error",
        f"Without noise joint 1 stands at its limit from {span[0]} to {span[1]} ({ticks} ticks); without limit it "
        f"would take {peaks[same]}. It keeps within {limit} where the motion may take {long:g} s ({peaks[long]}), not "
        f"where it takes {short:g} s ({peaks[short]}). With limit the error is {reported} (as reported) and {sound} "
        f"(full equations), without limit {free_reported} and {free_sound}: near the axis it is the torque limit that "
        "sets the error, not the law.",
        ticks > 10.0,
        peaks[same] > 1.2 * limit,
        peaks[short] > 1.1 * limit,
        peaks[long] < 0.97 * limit,
        reported.near(sound, 0.15),
        sound > 10.0 * free_sound,
        free_reported > 10.0 * free_sound,
    )


def _unlimited(runs: Mapping[str, Run]) -> Finding:
    run, limited = runs["singular"], runs["figure_3_5/sound"]
    failure = run.failure or {}
    time = Measured("time at which the goal move without limit diverges", failure.get("time"), "s")
    closest = Measured("the goal move with limit passes the base axis at", _passes(limited, "tip"), "m")
    settled = measured(limited, "settling_time", "settling time with limit")
    return finding(
        "Without a limit the goal move diverges",
        f"The goal move of figure 3.5 comes to within {closest} of the base axis. Under the law as printed, sampled at "
        f"{number(1e3 * float(run.config['controller']['period']))} ms, without noise and without a torque limit, it "
        f"diverges at {time} (joint {failure.get('joint', '–')}). The torque limit hides this: with it the move "
        f"settles after {settled}. Outside this report the runner therefore damps the inverse of J near singular "
        "postures (controller.singularity_damping).",
        time < 1.0,
        closest < 5e-3,
        settled < 4.0,
    )


def _passes(run: Run, signal: str) -> float:
    """Return the distance at which a path of the tip passes the base axis, between its ticks too, in m."""
    path, point = columns(run.trace, signal)[:, :2], model_of(run).shoulder[:2]
    start, step = path[:-1], np.diff(path, axis=0)
    squared = np.maximum(np.einsum("ij,ij->i", step, step), 1e-300)
    share = np.clip(np.einsum("ij,ij->i", point - start, step) / squared, 0.0, 1.0)
    distances = np.linalg.norm(start + share[:, None] * step - point, axis=1)
    return float(np.min(distances[np.isfinite(distances)], initial=np.inf))


def duration_section(runs: Mapping[str, Run]) -> Section:
    """Return the largest tracking error against the duration of the motion, beside the printed values."""
    printed = printed_tracking_errors()
    t = np.array(DURATIONS)
    panels = []
    for figure, title in zip(TRACKED, ("Limit of 50 N m (claim 3)", "No torque limit (claim 4)"), strict=True):
        series = [Series(PRESET[preset], t, _errors(runs, figure, preset), "points_line") for preset in PRESETS]
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
            _no_duration(runs, {figure: printed[figure][-1] for figure in TRACKED}),
            Text("All runs of this report take 3 s."),
        ),
    )


def printed_tracking_errors() -> dict[str, tuple[float, ...]]:
    """Return what the thesis prints of the largest tracking error, by figure, in m; figures have other claims, too."""
    return {
        claim.experiment.rpartition("/")[2]: tuple(claim.printed)
        for claim in load_claims("thesis")
        if claim.metric == "max_tracking_error"
    }


def _no_duration(runs: Mapping[str, Run], printed: Mapping[str, float]) -> Finding:
    t = np.array(DURATIONS)
    limited, free = (
        Measured(
            f"$t_f$ at which the error is that printed, {name}",
            float(np.interp(-printed[figure], -_errors(runs, figure, "as_reported"), t)),
            "s",
        )
        for figure, name in zip(TRACKED, ("torque limit", "no limit"), strict=True)
    )
    return finding(
        "No single duration meets both printed errors as reported",
        f"The largest printed error without limit, {quantity(printed['figure_3_10'], 'm')}, asks for $t_f$ = {free}, "
        f"the largest with limit, {quantity(printed['figure_3_9'], 'm')}, for $t_f$ = {limited}.",
        free > 1.3 * limited,
        free < 0.95 * DURATIONS[-1],
        limited > 1.05 * DURATIONS[0],
    )


def _errors(runs: Mapping[str, Run], figure: str, preset: str) -> FloatArray:
    return values((runs[f"{figure}/{preset}/{t_f}"] for t_f in DURATIONS), "max_tracking_error")
