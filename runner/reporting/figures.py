"""Figures of stored runs: curves, motions, and the picture on the first screen."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.quantities import quantity
from runner.reporting.charts.arm import WIDE, arm_motion, moving_arm
from runner.reporting.charts.figure import spaced_indices
from runner.reporting.document import Cover, Curves, Origin, Panel, Playback, Series
from runner.reporting.playback import joint_places, playback_bodies
from runner.store import Calibration, Run

AXES = ("x", "y", "z")
LEAVES_AXES = "A curve that leaves the axes diverges."
_LAST, _LAST_ROWS = 0.02, 20  # s and rows before a failure
_STILLS = 6  # instants in the still picture of a motion
_FRAMES = 30


def origin(job: Run | Calibration, number: str = "") -> Origin:
    """Return the origin of a figure of a run or calibration: the command that made it, and its commit."""
    commit = str(job.provenance["commit"] or "")
    return Origin(number, str(job.provenance["command"]), commit[:12] + commit[40:])


def captioned(caption: str, panels: Sequence[Panel], columns: int, where: Origin) -> Curves:
    """Return a figure; if its caption has a line break, the first line is its finding."""
    finding, _, shown = caption.rpartition("\n")
    return Curves(shown, panels, columns, where, finding)


def rows_until(run: Run, end: float | None) -> slice:
    """Return the rows of a run's trace up to a time, in s; None means all."""
    return slice(None) if end is None else slice(int(np.count_nonzero(run.t <= end + 1e-9)))


def torque_and_error(run: Run, caption: str) -> Curves:
    """Return the torque of each joint (force of prismatic joints) and the tip error in x, y, z over time."""
    t, torques, error = run.t, run.joints("tau"), run.vector("error")
    force = [run.units[f"tau{joint + 1}"] == "N" for joint in range(torques.shape[1])]
    panels = []
    for title, label, slides in (("Torque", "torque (N m)", False), ("Force", "force (N)", True)):
        joints = [
            Series(name, t, torques[:, i], color=i)
            for i, (name, is_force) in enumerate(zip(run.provenance["joints"], force, strict=True))
            if is_force == slides
        ]
        if joints:
            panels.append(Panel(f"{title} of each joint", "time (s)", label, joints))
    axes = [Series(axis, t, error[:, index]) for index, axis in enumerate(AXES)]
    return Curves(
        caption,
        (*panels, Panel("Tip position error", "time (s)", "tip error (m)", axes)),
        origin=origin(run),
    )


def before_failure(run: Run, failed_at: float) -> list[Curves]:
    """Return torques and tip error of a failed run over its last 20 ms, or last rows if these take longer; then all.

    The vertical axes end at four times the median size of the last values; a diverging curve leaves them. A run that
    is no longer than its last moments has one figure.

    Args:
        run: The run.
        failed_at: Time of the failure, in s.
    """
    start = max(0.0, min(failed_at - _LAST, float(run.t[-min(len(run.t), _LAST_ROWS)])))
    told = f"Torque of each joint and tip position error up to the failure, repetition 0. {LEAVES_AXES}"
    whole = _cut(torque_and_error(run, told), 0.0, failed_at)
    if start == 0.0:
        return [whole]
    last = torque_and_error(run, f"The last moments before the failure, repetition 0. {LEAVES_AXES}")
    return [_cut(last, start, failed_at), whole]


def _cut(shown: Curves, start: float, end: float) -> Curves:
    """Return curves over a time, in s; the vertical axes end at four times the median size of the values."""
    panels = []
    for panel in shown.panels:
        values = np.abs(np.concatenate([each.y[each.x >= start] for each in panel.series]))
        sound = values[np.isfinite(values) & (values > 0.0)]
        size = 4.0 * float(np.median(sound)) if len(sound) else 1.0
        panels.append(replace(panel, x_range=(start, end), y_range=(-size, size)))
    return replace(shown, panels=panels)


def desired_motion(run: Run, caption: str, number: str = "", axes: tuple[str, ...] = AXES) -> Curves:
    """Return desired position, velocity and acceleration of the tip over the motion's time, of a shaped one all."""
    rows = rows_until(run, None if "input_shaper" in run.config else run.config["trajectory"]["duration"])
    t = run.t[rows]
    panels = [
        Panel(
            title,
            "time (s)",
            f"{title.lower()} ({unit})",
            [Series(axis, t, run.signal(f"{stem}_{axis}")[rows], color=AXES.index(axis)) for axis in axes],
        )
        for title, stem, unit in (
            ("Desired position", "desired", "m"),
            ("Desired velocity", "desired_velocity", "m/s"),
            ("Desired acceleration", "desired_acceleration", "m/s²"),
        )
    ]
    return Curves(caption, panels, columns=3, origin=origin(run, number))


def playback(run: Run, caption: str, until: float | None = None, frames: int = 120, has_still: bool = True) -> Playback:
    """Return the motion of a run in three dimensions.

    Args:
        run: The run.
        caption: What moves.
        until: End of the part shown, in s; None shows it all.
        frames: Largest number of instants.
        has_still: Whether it has a still picture, which takes most of the time.
    """
    model, (t, q, tip, desired) = run.model, _motion(run, until)
    shown = spaced_indices(len(t), frames)
    moving = bool(np.ptp(desired, axis=0).any())
    path = desired if moving else np.vstack([tip[0], desired[0]])
    return Playback(
        caption,
        t[shown],
        playback_bodies(run.urdf, model, q[shown]),
        tip,
        path,
        still_motion(run, until) if has_still else "",
        origin(run),
        ends=f"failed at {quantity(failure['time'], 's')}" if (failure := run.failure_record) else "",
        tip=tip[shown],
        target=desired[shown],
        joints=joint_places(model, q[shown]),
        draw=partial(still_motion, run, until) if has_still else None,
    )


def still_motion(run: Run, until: float | None = None, width: float = WIDE, has_words: bool = True) -> str:
    """Return the motion of a run as a still picture.

    Args:
        run: The run.
        until: End of the part shown, in s; None shows it all.
        width: Its width, in inches; see `arm_motion`.
        has_words: Whether it has a legend and labels, which a small one leaves out.
    """
    t, q, tip, desired = _motion(run, until)
    shown = spaced_indices(len(t), _STILLS)
    path = desired if np.ptp(desired, axis=0).any() else np.vstack([tip[0], desired[0]])
    return arm_motion(run.model, q[shown], t[shown].tolist(), tip, path, desired[-1],
                      has_words=has_words, width=width)  # fmt: skip


def _motion(run: Run, until: float | None) -> tuple[FloatArray, ...]:
    """Return time, joint positions, tip and desired tip up to a time, without the rows of a diverged arm."""
    rows = rows_until(run, until)
    columns = [values[rows] for values in (run.t, run.joints("q"), run.vector("tip"), run.vector("desired"))]
    finite = np.isfinite(np.hstack(columns[1:3])).all(axis=1)
    return tuple(values[finite] for values in columns)


def cover(run: Run, caption: str, until: float | None = None) -> Cover:
    """Return the picture of a run for the first screen.

    Args:
        run: The run.
        caption: What moves.
        until: End of the part shown, in s; None shows it all.
    """
    t, q, tip, desired = _motion(run, until)
    few, path = spaced_indices(len(t), _FRAMES), spaced_indices(len(t), 5 * _FRAMES)
    moving = moving_arm(run.model, q[few], float(t[-1] - t[0]), tip[path], desired[path])
    return Cover(caption, moving, playback(run, caption, until).still)
