"""The report's kinematics against our own: table, transform and Jacobians, element by element."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from runner.audit.audit import audit, counts
from runner.audit.verdict import Judged
from runner.reporting.document import FloatArray, Notice, Section, Table, Text
from runner.reporting.figures import model_of, origin
from runner.reporting.quantities import number
from runner.robots.denavit_hartenberg import modified_frames
from runner.robots.meca500 import TABLE
from runner.robots.model import RobotModel
from runner.store import Run

_COUNT, _SAMPLES = 1000, 200
_MILLIMETRES = 1000.0
_MATRICES = {
    "T": (3, 4, "the transform of frame 6, section 7.1"),
    "J_g0": (6, 6, "the Jacobian in the base frame, section 7.2"),
    "J_g6": (6, 6, "the Jacobian in frame 6, sections 1 and 7.2"),
}
_WORDS = {"correct": "right", "correct after repair": "right, text mended", "unreadable": "text lost"}


def kinematics_section(runs: Mapping[str, Run]) -> Section:
    """Return Table 1 with and without its lost turns, and the verdict on every printed element."""
    run = runs["plants/kinematic"]
    judged = [each for each in audit("meca500", _SAMPLES) if each.entry.place[0] in "17"]
    total = counts(judged)
    grids = [_grid(name, judged) for name in _MATRICES]
    return Section(
        "Kinematics, element by element",
        (
            Text(
                "Our modified D-H table is the report's Table 1 with two turns put back; the arm's URDF was built "
                f"independently. At {_COUNT} random postures within the joint limits:"
            ),
            _table_one(run),
            Text(
                "The appendix prints transform and Jacobians element by element, in mm. Each is evaluated as printed "
                f"at {_SAMPLES} random postures, against the product of the transforms of Table 1 and, second, "
                "differences of the position and the joint axes $z_i$. Where the text has lost a sign or a bracket it "
                "is mended and said so. All of it, with every expression and its correction, is what `runner "
                "reproduce audit` reports; here are the verdicts, and the largest error of what is wrong, in mm/rad "
                "in rows 0 to 2 of the Jacobians and 1 below."
            ),
            *grids,
            Notice(
                "finding",
                "Lengths and transform are right; the angular rows are no velocity Jacobian",
                f"Of {len(judged)} equations {total['correct']} are right as printed, "
                f"{total['correct after repair']} where the text is mended, {total['wrong as printed']} wrong, and "
                f"{total['unreadable']} lost. Table 1 needs $theta_2 = q_2 - 90°$ and $theta_6 = q_6 + 180°$. In the "
                'transform "-C_2" stands for the factor $sin(theta_2 - 90°)$. The linear rows are right but for one '
                "root. The angular rows bear terms with a bare angle: they differentiate $sum theta_i z_i$, where the "
                "angular velocity is $sum z_i dot(theta)_i$; without these terms each is the joint's axis.",
            ),
        ),
    )


def _table_one(run: Run) -> Table:
    flange = RobotModel(run.urdf, run.config["robot"]["tip"], run.config["gravity"])
    low, high = np.clip(model_of(run).position_limits, -np.pi, np.pi)
    postures = np.random.default_rng(0).uniform(low, high, (_COUNT, len(TABLE)))
    true = np.array([flange.tip_pose(q) for q in postures])
    cases = {
        "with both turns": (),
        "without -90° of joint 2": (1,),
        "without 180° of joint 6": (5,),
        "as printed, without both": (1, 5),
    }
    rows = [[name, *_off(turned, postures, true)] for name, turned in cases.items()]
    return Table(
        "Table 1 as a modified D-H table, against the arm's URDF.",
        ["table", "mean distance of frame 6 (mm)", "largest (mm)", "mean turn (degrees)"],
        rows,
        (1, 2, 3),
        origin(run, "Table 1"),
    )


def _off(turned: Sequence[int], postures: FloatArray, true: FloatArray) -> list[str]:
    """Return mean and largest distance, and mean turn, of frame 6 by the table without some of its turns."""
    table = [replace(row, theta=0.0) if index in turned else row for index, row in enumerate(TABLE)]
    poses = np.array([modified_frames(table, q)[-1] for q in postures])
    distance = _MILLIMETRES * np.linalg.norm(poses[:, :3, 3] - true[:, :3, 3], axis=1)
    chord = np.linalg.norm(poses[:, :3, :3] - true[:, :3, :3], axis=(1, 2))  # 2 sqrt(2) sin(angle / 2)
    angle = np.degrees(2.0 * np.arcsin(np.minimum(chord / np.sqrt(8.0), 1.0)))
    return [number(float(value)) for value in (distance.mean(), distance.max(), angle.mean())]


def _grid(name: str, judged: Sequence[Judged]) -> Table:
    """Return the verdict on each element of a printed matrix, in its place."""
    rows, columns, what = _MATRICES[name]
    found: dict[tuple[int, int], str] = {}
    for each in judged:
        for element in (each.entry.repair or each.entry.printed).elements:
            place = re.fullmatch(rf"{name}_(\d)(\d)", element)
            if place is not None:
                found.setdefault((int(place[1]), int(place[2])), _cell(each, element))
    cells = [[str(row), *(found.get((row, column), "text lost") for column in range(columns))] for row in range(rows)]
    return Table(f"Elements of {what}.", ["row", *(f"column {column}" for column in range(columns))], cells)


def _cell(judged: Judged, element: str) -> str:
    if judged.verdict in _WORDS or judged.measured is None:
        return _WORDS.get(judged.verdict, "text lost")
    return f"wrong by up to {number(judged.measured.elements[element], 2)}"
