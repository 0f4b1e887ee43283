"""Chapter 3: kinematics, dynamics and control of the Macro."""

from collections.abc import Mapping

from runner.reporting.document import Section, Text
from runner.reporting.figures import desired_motion, playback
from runner.store import Run
from runner.works.thesis.arm import control_law, dynamics, kinematics, reproduced

GOAL_METRICS = ("settling_time", "steady_state_error", "overshoot", "peak_torque", "saturation_fraction")
TRACKING_METRICS = (
    "max_tracking_error",
    "max_tracking_error_x",
    "max_tracking_error_y",
    "max_tracking_error_z",
    "rms_tracking_error",
    "steady_state_error",
    "peak_torque",
    "saturation_fraction_q1",
)


def chapter3(runs: Mapping[str, Run]) -> Section:
    """Return figures 3.1 to 3.10 and table 3.1."""
    goal, limited, free = (runs[f"{name}/sound"] for name in ("figure_3_5", "figure_3_9", "figure_3_10"))
    return Section(
        "Chapter 3: the Macro manipulator",
        sections=(
            kinematics(goal, "figure 3.1", "table 3.1", 0, "E"),
            dynamics(goal, 1.0, 1.0),
            Section(
                "Goal position",
                (
                    *control_law(goal, True, "figure 3.4"),
                    *reproduced(runs, "3.5", "Macro, goal position, 50 N m", GOAL_METRICS),
                    playback(runs["figure_3_5/as_reported"], "Macro, goal position, as reported: the first 2 s.", 2.0),
                ),
            ),
            Section(
                "Trajectory tracking",
                (
                    desired_motion(runs["figure_3_6/sound"], "The quintic in x direction.", "figure 3.6", ("x",)),
                    *control_law(free, False, "figure 3.7"),
                    desired_motion(
                        runs["figure_3_8/sound"], "Desired trajectory of the Macro, $t_f = 3$ s.", "figure 3.8"
                    ),
                    *reproduced(runs, "3.9", "Macro, tracking, limit of 50 N m", TRACKING_METRICS),
                    *reproduced(runs, "3.10", "Macro, tracking, no torque limit", TRACKING_METRICS),
                    playback(limited, "Macro, tracking with the limit of 50 N m, full equations.", 3.0),
                    Text(
                        "The thesis does not print $t_f$; its plots' time axes are lost with the images. All runs "
                        "take 3 s."
                    ),
                ),
            ),
        ),
    )
