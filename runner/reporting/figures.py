"""Figures of a stored run in the layout of the thesis, and its picture on the first screen."""

import numpy as np
import pandas as pd

from runner.reporting.bodies import playback_bodies
from runner.reporting.charts.arm import arm_motion, moving_arm
from runner.reporting.charts.thinning import spaced_indices
from runner.reporting.document import Cover, Curves, Origin, Panel, Playback, Series
from runner.robots import RobotModel
from runner.store import Calibration, Run

AXES = ("x", "y", "z")
_STILLS = 6  # instants in the still picture of a motion
_FRAMES = 60


def origin(job: Run | Calibration, number: str = "") -> Origin:
    """Return where a figure of a run or calibration comes from: the command that made it, and its commit."""
    commit = str(job.provenance["commit"] or "")
    return Origin(number, str(job.provenance["command"]), commit[:12] + commit[40:])


def model_of(run: Run) -> RobotModel:
    """Return the rigid-body model of the robot that a run simulated, from the URDF stored with it."""
    return RobotModel(run.urdf, run.provenance["tip_frame"], run.config["gravity"])


def until_time(run: Run, end: float | None) -> pd.DataFrame:
    """Return the trace of a run up to a time, in s; None returns it all."""
    trace = run.trace()
    return trace if end is None else trace[trace["t"] <= end + 1e-9]


def columns(trace: pd.DataFrame, stem: str) -> np.ndarray:
    """Return the columns of one signal, shape (T, 3) for a tip signal: those named stem_x, stem_y, stem_z."""
    return trace[[f"{stem}_{axis}" for axis in AXES]].to_numpy()


def joint_columns(trace: pd.DataFrame, stem: str) -> np.ndarray:
    """Return the columns of one joint signal, shape (T, nq): those named stem1, stem2, ..."""
    names = [name for name in trace.columns if name.startswith(stem) and name[len(stem) :].isdigit()]
    return trace[names].to_numpy()


def torque_and_error(run: Run, caption: str, number: str = "", until: float | None = None) -> Curves:
    """Return the thesis' layout: torque of each joint (force of those that slide), and tip error in x, y, z, over time.

    Args:
        run: The run.
        caption: What is seen.
        number: Number of the figure in the source.
        until: End of the time axis, in s; None shows the whole run.
    """
    trace = until_time(run, until)
    t = trace["t"].to_numpy()
    torques = joint_columns(trace, "tau")
    error = columns(trace, "error")
    force = [run.units[f"tau{joint + 1}"] == "N" for joint in range(torques.shape[1])]
    panels = []
    for title, label, slides in (("Torque", "torque (N m)", False), ("Force", "force (N)", True)):
        joints = [
            Series(str(i + 1), t, torques[:, i], color=i) for i, is_force in enumerate(force) if is_force == slides
        ]
        if joints:
            panels.append(Panel(f"{title} of each joint", "time (s)", label, joints))
    axes = [Series(axis, t, error[:, index]) for index, axis in enumerate(AXES)]
    return Curves(
        caption,
        (*panels, Panel("Tip position error", "time (s)", "error (m)", axes)),
        origin=origin(run, number),
    )


def desired_motion(run: Run, caption: str, number: str = "", axes: tuple[str, ...] = AXES) -> Curves:
    """Return desired position, velocity and acceleration of the tip over the motion's time, of a shaped one all."""
    trace = until_time(run, None if "input_shaper" in run.config else run.config["trajectory"]["duration"])
    t = trace["t"].to_numpy()
    panels = [
        Panel(
            title,
            "time (s)",
            f"{title.split()[-1]} ({unit})",
            [Series(axis, t, trace[f"{stem}_{axis}"].to_numpy(), color=AXES.index(axis)) for axis in axes],
        )
        for title, stem, unit in (
            ("Desired position", "desired", "m"),
            ("Desired velocity", "desired_velocity", "m/s"),
            ("Desired acceleration", "desired_acceleration", "m/s²"),
        )
    ]
    return Curves(caption, panels, columns=3, origin=origin(run, number))


def playback(run: Run, caption: str, until: float | None = None, frames: int = 120) -> Playback:
    """Return the motion of a run in three dimensions.

    Args:
        run: The run.
        caption: What moves.
        until: End of the part shown, in s; None shows it all.
        frames: Largest number of instants.
    """
    trace = until_time(run, until)
    trace = trace[np.isfinite(np.hstack([joint_columns(trace, "q"), columns(trace, "tip")])).all(axis=1)]
    model = model_of(run)
    q, t, tip = joint_columns(trace, "q"), trace["t"].to_numpy(), columns(trace, "tip")
    shown = spaced_indices(len(t), frames)
    stills = spaced_indices(len(t), _STILLS)
    desired = columns(trace, "desired")
    moving = bool(np.ptp(desired, axis=0).any())
    path = desired if moving else np.vstack([tip[0], desired[0]])
    still = arm_motion(model, q[stills], t[stills].tolist(), path=tip, desired=path, goal=desired[-1])
    return Playback(caption, t[shown], playback_bodies(run.urdf, model, q[shown]), tip, path, still, origin(run))


def macro_mini_targets(
    run: Run, number: str = "", caption: str = "", until: float | None = None, axis: str = "x"
) -> Curves:
    """Return how the way to the desired tip is shared between the carrying arm and the riding one, along one axis.

    Args:
        run: A run of a robot with two stages.
        number: Number of the figure in the source.
        caption: What is seen; "" takes a sentence of its own.
        until: End of the time axis, in s; None shows the whole run.
        axis: The axis of the base frame: x, y or z.
    """
    trace = until_time(run, until)
    macro, mini = list(run.provenance["stages"])[:2]
    t = trace["t"].to_numpy()
    desired, tip, end_point = (trace[f"{stem}_{axis}"].to_numpy() for stem in ("desired", "tip", f"{macro}_tip"))
    big, small = macro.capitalize(), mini.capitalize()
    positions = (
        Series("tip", t, tip, color=0),
        Series(f"{big} end point", t, end_point, color=1),
        Series("desired tip", t, desired, "dashed", color=7),
    )
    shares = (
        Series(f"tip less {big} end point", t, tip - end_point, color=0),
        Series(f"desired tip less {big} end point", t, desired - end_point, "dashed", color=7),
    )
    panels = (
        Panel(f"Positions in {axis} direction", "time (s)", f"{axis} (m)", positions),
        Panel(f"The {small}'s share of them", "time (s)", f"{axis} (m)", shares),
    )
    caption = caption or f"How {big} and {small} share the way to the desired tip, in {axis} direction."
    return Curves(caption, panels, origin=origin(run, number))


def cover(run: Run, caption: str, until: float | None = None) -> Cover:
    """Return the picture of a run for the first screen.

    Args:
        run: The run.
        caption: What moves.
        until: End of the part shown, in s; None shows it all.
    """
    trace = until_time(run, until)
    trace = trace[np.isfinite(joint_columns(trace, "q")).all(axis=1)]
    q, t, tip = joint_columns(trace, "q"), trace["t"].to_numpy(), columns(trace, "tip")
    few, path = spaced_indices(len(t), _FRAMES), spaced_indices(len(t), 5 * _FRAMES)
    desired = columns(trace, "desired")[path]
    moving = moving_arm(model_of(run), q[few], float(t[-1] - t[0]), tip[path], desired)
    return Cover(caption, moving, playback(run, caption, until).still)
