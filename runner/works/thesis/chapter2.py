"""Chapter 2: structure and parameters of both arms."""

from collections.abc import Mapping

import numpy as np

from runner.reporting.document import Block, Picture, Section, Table, Text
from runner.reporting.drawings import workspace_sphere
from runner.reporting.figures import model_of, origin
from runner.reporting.quantities import above_rounding, number
from runner.robots import RobotModel
from runner.robots.denavit_hartenberg import denavit_hartenberg
from runner.robots.workspace import analyse
from runner.store import Run

_SAMPLES = 4000


def chapter2(runs: Mapping[str, Run]) -> Section:
    """Return table 2.1 and figures 2.3 and 2.4."""
    macro, mini = runs["figure_3_5/sound"], runs["figure_4_2/sound"]
    return Section(
        "Chapter 2: structure and parameters",
        sections=(
            Section("Software model and parameters", (_parameters(macro, mini),)),
            Section(
                "Workspace",
                (
                    Text(
                        "With no joint limits the workspace of two equal links is a full ball around the shoulder. "
                        "The thesis draws its outer sphere. The cross-section adds what the sphere does not show: "
                        "how freely the tip moves. $|det J_v| = L^3 |c_3 (c_2 - s_23)|$ vanishes on the sphere, at "
                        "its centre, and on the whole base axis, so the workspace has a singular line through its "
                        "middle."
                    ),
                    *_workspace("Macro", "figure 2.3", macro),
                    *_workspace("Mini", "figure 2.4", mini),
                ),
            ),
        ),
    )


def _parameters(macro: Run, mini: Run) -> Table:
    rows = []
    for name, run in (("Macro", macro), ("Mini", mini)):
        model, robot = model_of(run), run.config["robot"]
        lengths = [row.a for row in denavit_hartenberg(model)]
        rows.append(
            [
                name,
                _list(lengths),
                _list(_link_masses(model)),
                "none",
                f"±{number(robot['joint_error_limit'], 1)}",
                number(1e3 * robot["period"]),
                number(robot["torque_limit"]),
            ]
        )
    header = [
        "manipulator",
        "link lengths (m)",
        "link masses (kg)",
        "joint limits",
        "joint error limit (rad)",
        "sample time (ms)",
        "max. continuous torque (N m)",
    ]
    return Table(
        "Parameters of both manipulators; lengths and masses read from the model, not typed. (The thesis prints the "
        "joint range as 0° to 360° and means that there is no limit.)",
        header,
        rows,
        (5, 6),
        origin(macro, "table 2.1"),
    )


def _link_masses(model: RobotModel) -> list[float]:
    return [float(inertia.mass) for inertia in list(model.pin_model.inertias)[1:]]


def _list(values: list[float]) -> str:
    return f"[{' '.join(f'{value:g}' for value in values)}]"


def _workspace(name: str, figure: str, run: Run) -> list[Block]:
    found = analyse(model_of(run), _SAMPLES, np.random.default_rng(0))
    return [
        Picture(
            f"Workspace of the {name}: {_SAMPLES} sampled tip positions in the sphere of reach, and a meridian "
            f"cross-section coloured by manipulability. Largest distance from the shoulder {number(found.outer, 4)} "
            f"m (sum of the link lengths {number(found.reach, 4)} m), smallest {above_rounding(found.inner, 'm')}.",
            workspace_sphere(found),
            f"A sphere of radius {found.outer:.3g} m filled with points, and its cross-section",
            1.0,
            origin(run, figure),
        )
    ]
