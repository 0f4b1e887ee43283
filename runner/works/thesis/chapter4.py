"""Chapter 4: kinematics, dynamics and control of the Mini."""

from collections.abc import Mapping

from runner.reporting.document import Section, Text
from runner.reporting.figures import desired_motion, playback
from runner.store import Run
from runner.works.thesis.arm import dynamics, kinematics, reproduced
from runner.works.thesis.chapter3 import GOAL_METRICS, TRACKING_METRICS


def chapter4(runs: Mapping[str, Run]) -> Section:
    """Return figures 4.1 to 4.4 and table 4.1."""
    goal = runs["figure_4_2/sound"]
    return Section(
        "Chapter 4: the Mini manipulator",
        sections=(
            kinematics(goal, "figure 4.1", "table 4.1", 3, "6"),
            dynamics(goal, 0.1, 0.1),
            Section(
                "Goal position",
                (
                    Text("The law is the Macro's, with $omega_n = 300$ rad/s, 1 ms and 5 N m."),
                    *reproduced(runs, "4.2", "Mini, goal position, 5 N m", GOAL_METRICS, 0.4),
                ),
            ),
            Section(
                "Trajectory tracking",
                (
                    desired_motion(
                        runs["figure_4_3/sound"], "Desired trajectory of the Mini, $t_f = 3$ s.", "figure 4.3"
                    ),
                    *reproduced(runs, "4.4", "Mini, tracking, 5 N m", TRACKING_METRICS),
                    playback(runs["figure_4_4/sound"], "Mini, tracking, full equations.", 3.0),
                ),
            ),
        ),
    )
