"""The report's kinematics against our own: table, transform and Jacobians, element by element."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from runner.audit.audit import audit, counts
from runner.audit.entry import parts
from runner.audit.evaluation import evaluate
from runner.audit.expressions import parse
from runner.audit.verdict import Judge, Judged
from runner.reporting.document import FloatArray, Section, Table, Text
from runner.reporting.figures import model_of, origin
from runner.reporting.findings import Finding, finding
from runner.reporting.measured import Measured
from runner.reporting.quantities import number
from runner.robots.denavit_hartenberg import modified_frames
from runner.robots.meca500 import TABLE
from runner.robots.model import RobotModel
from runner.store import Run

_COUNT, _SAMPLES = 1000, 200
_MILLIMETRES = 1000.0
_NOTHING = 1e-4  # mm or degrees: the chord of two equal rotations is known to the root of rounding
_MATRICES = {
    "T": (3, 4, "the transform of frame 6, section 7.1"),
    "J_g0": (6, 6, "the Jacobian in the base frame, section 7.2"),
    "J_g6": (6, 6, "the Jacobian in frame 6, sections 1 and 7.2"),
}
_WORDS = {"correct": "right", "correct after repair": "right, text mended", "unreadable": "text lost"}


def kinematics_section(runs: Mapping[str, Run]) -> Section:
    """Return Table 1 with and without its lost turns, and the verdict on every printed element."""
    run = runs["plants/kinematic"]
    grids = [_grid(name, _judged()) for name in _MATRICES]
    return Section(
        "Kinematics, element by element",
        (
            Text(
                "The modified D-H table used here is the report's Table 1 with two turns put back; the arm's URDF "
                f"was built independently. At {_COUNT} random postures within the joint limits:"
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
            kinematics_finding(**kinematics_values(runs)),
        ),
    )


def kinematics_values(runs: Mapping[str, Run]) -> dict[str, Measured]:
    """Return what the finding on the printed kinematics is about."""
    judged = _judged()
    total = counts(judged)
    cells = [cell for name in _MATRICES for row in _grid(name, judged).rows for cell in row[1:]]
    transform, linear, angular = (_readable(judged, rows) for rows in (r"T_\d\d", "J_g._[012]", "J_g._[345]"))
    off = _turns_off(runs["plants/kinematic"])
    return {
        "equations": Measured("equations", len(judged)),
        "right": Measured("equations right as printed", total["correct"]),
        "mended": Measured("equations right after repair", total["correct after repair"]),
        "wrong": Measured("equations wrong as printed", total["wrong as printed"]),
        "lost": Measured("equations that cannot be read", total["unreadable"]),
        "names": Measured("equations that only name things", total["definition"]),
        "cells": Measured("elements without a readable equation", cells.count(_WORDS["unreadable"])),
        "table": Measured("largest distance of frame 6 with both turns", off["with both turns"][1], "mm"),
        "without_2": Measured(
            "mean distance of frame 6 without -90° of joint 2", off["without -90° of joint 2"][0], "mm"
        ),
        "without_6": Measured("mean turn of frame 6 without 180° of joint 6", off["without 180° of joint 6"][2], "°"),
        "transform_wrong": Measured("wrong elements of the transform", transform[1]),
        "linear": Measured("readable equations of the linear rows", linear[0]),
        "linear_wrong": Measured("wrong ones of the linear rows", linear[1]),
        "angular": Measured("readable equations of the angular rows", angular[0]),
        "angular_wrong": Measured("wrong ones of the angular rows", angular[1]),
        "axes": Measured("those that are the joint's axis without terms that bear an angle", _axes(judged)),
    }


def kinematics_finding(
    equations: Measured,
    right: Measured,
    mended: Measured,
    wrong: Measured,
    lost: Measured,
    names: Measured,
    cells: Measured,
    table: Measured,
    without_2: Measured,
    without_6: Measured,
    transform_wrong: Measured,
    linear: Measured,
    linear_wrong: Measured,
    angular: Measured,
    angular_wrong: Measured,
    axes: Measured,
) -> Finding:
    """Return what of the printed kinematics is right."""
    return finding(
        "Lengths and transform are right; the angular rows are no velocity Jacobian",
        f"Of {equations} equations {right} are right as printed, {mended} where the text is mended, {wrong} wrong, "
        f"{lost} cannot be read, and {names} only names things: the layout of the transform's elements. These are "
        f"numbers of equations; the tables above show elements, of which {cells} have no readable equation, as some "
        "equations are missing from the text altogether. Table 1 needs $theta_2 = q_2 - 90°$, without which frame 6 is "
        f"{without_2} off, and $theta_6 = q_6 + 180°$, without which it is turned by {without_6}. In the transform, of "
        'which no element is wrong once mended, "-C_2" stands for the factor $sin(theta_2 - 90°)$. Of the '
        f"{linear} readable equations of the linear rows {linear_wrong} is wrong, a root; of the {angular} of the "
        f"angular rows {angular_wrong}: these bear terms with a bare angle, as they differentiate $sum theta_i z_i$, "
        f"where the angular velocity is $sum z_i dot(theta)_i$; without these terms {axes} of them are the joint's "
        "axis.",
        (equations - right - mended - wrong - lost).near(names, 0.0),
        names.near(1.0, 0.0),
        cells > 1.5 * lost,
        table < 1e-6,
        without_2 > 10.0,
        without_6.near(180.0, 1e-6),
        transform_wrong < 1.0,
        linear_wrong.near(1.0, 0.0),
        linear > 10.0,
        angular_wrong > 0.6 * angular,
        axes >= angular_wrong,
    )


def _judged() -> list[Judged]:
    return [each for each in audit("meca500", _SAMPLES) if each.entry.place[0] in "17"]


def _readable(judged: Sequence[Judged], names: str) -> tuple[int, int]:
    """Return how many equations for elements of such names can be read, and how many of these are wrong."""
    found = [
        each.verdict
        for each in judged
        if each.measured is not None and any(re.match(names, name) for name in each.measured.elements)
    ]
    return len(found), found.count("wrong as printed")


def _axes(judged: Sequence[Judged]) -> int:
    """Return how many wrong equations of the angular rows are right where every bare angle is zero."""
    wrong = {each.entry.id for each in judged if each.verdict == "wrong as printed"}
    found = 0
    for part in parts("meca500"):
        symbols = Judge(part, _SAMPLES).symbols
        zeros = {name: 0.0 * values if re.fullmatch(r"theta\d", name) else values for name, values in symbols.items()}
        for entry in part.entries:
            form, right = entry.repair or entry.printed, entry.corrected
            names = [name for name in form.elements if re.match("J_g._[345]", name)]
            if entry.id in wrong and right is not None and names:
                off = [
                    evaluate(parse(form.elements[name]), zeros) - evaluate(parse(right.elements[name]), symbols)
                    for name in names
                ]
                found += bool(np.abs(off).max() <= entry.tolerance)
    return found


def _turns_off(run: Run) -> dict[str, tuple[float, float, float]]:
    """Return how far frame 6 is off by Table 1 with and without its lost turns."""
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
    return {name: _off(turned, postures, true) for name, turned in cases.items()}


def _table_one(run: Run) -> Table:
    rows = [[name, *(number(value, rounding=_NOTHING) for value in off)] for name, off in _turns_off(run).items()]
    return Table(
        "Table 1 as a modified D-H table, against the arm's URDF.",
        ["table", "mean distance of frame 6 (mm)", "largest (mm)", "mean turn (degrees)"],
        rows,
        (1, 2, 3),
        origin(run, "Table 1"),
    )


def _off(turned: Sequence[int], postures: FloatArray, true: FloatArray) -> tuple[float, float, float]:
    """Return mean and largest distance in mm, and mean turn in degrees, of frame 6 by a table without some turns."""
    table = [replace(row, theta=0.0) if index in turned else row for index, row in enumerate(TABLE)]
    poses = np.array([modified_frames(table, q)[-1] for q in postures])
    distance = _MILLIMETRES * np.linalg.norm(poses[:, :3, 3] - true[:, :3, 3], axis=1)
    chord = np.linalg.norm(poses[:, :3, :3] - true[:, :3, :3], axis=(1, 2))  # 2 sqrt(2) sin(angle / 2)
    angle = np.degrees(2.0 * np.arcsin(np.minimum(chord / np.sqrt(8.0), 1.0)))
    return float(distance.mean()), float(distance.max()), float(angle.mean())


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
