"""Parameters and workspaces of both arms, from their models."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.base.quantities import above_rounding, number
from runner.reporting.document import Picture, Table
from runner.reporting.figures import origin
from runner.reporting.table import numbers
from runner.robots.workspace import analyse
from runner.studies.thesis.denavit_hartenberg import denavit_hartenberg
from runner.studies.thesis.diagrams.workspace import workspace_sphere
from runner.study.results import Runs

_SAMPLES = 4000


def parameters(
    runs: Runs, caption: str, figure: str, arms: Mapping[str, str], printed: Mapping[str, Sequence[str]]
) -> Table:
    """Return the parameters of some arms, by name, each with a run of it, and the printed ones below."""
    rows = []
    for name, run in ((name, runs[run]) for name, run in arms.items()):
        model, robot = run.model, run.config["robot"]
        rows.append(
            [
                name,
                _list([row.a for row in denavit_hartenberg(model)]),
                _list([inertia.mass for inertia in list(model.pin_model.inertias)[1:]]),
                "none",
                f"±{number(robot['joint_error_limit'], 1)}",
                number(1e3 * robot["period"]),
                number(robot["torque_limit"]),
            ]
        )
        rows.append([f"{name}, printed", *printed[name]])
    header = (
        *("manipulator", "link lengths (m)", "link masses (kg)", "joint limits", "joint error limit (rad)"),
        *numbers("sample time (ms)", "max. continuous torque (N m)"),
    )
    return Table(caption, header, rows, origin(runs[next(iter(arms.values()))], figure), prose=True)


def workspace(runs: Runs, run: str, name: str, figure: str) -> Picture:
    """Return the sphere of reach of an arm with sampled tip positions, and a cross-section by manipulability."""
    found = analyse(runs[run].model, _SAMPLES, np.random.default_rng(0))
    return Picture(
        f"Workspace of the {name}: {_SAMPLES} sampled tip positions in the sphere of reach, and a meridian "
        f"cross-section coloured by manipulability. Largest distance from the shoulder {number(found.outer, 4)} "
        f"m (sum of the link lengths {number(found.reach, 4)} m), smallest {above_rounding(found.inner, 'm')}.",
        workspace_sphere(found),
        f"A sphere of radius {found.outer:.3g} m filled with points, and its cross-section",
        0.62,
        origin(runs[run], figure),
    )


def _list(values: Sequence[float]) -> str:
    return f"[{' '.join(f'{value:g}' for value in values)}]"
