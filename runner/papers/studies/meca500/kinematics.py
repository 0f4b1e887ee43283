"""Printed kinematics compared with the model: D-H table, transform and Jacobians, by element."""

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from runner.base.quantities import number
from runner.papers.audit.audit import audit, counts
from runner.papers.audit.entry import parts
from runner.papers.audit.evaluation import evaluate
from runner.papers.audit.verdict import Check, CheckedEquation
from runner.papers.expressions.parser import parse
from runner.papers.studies.meca500.equations.derivations.meca500 import TABLE, frames
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs
from runner.reporting.document import Table
from runner.robots.model import RobotModel

_COUNT, _SAMPLES = 1000, 200
_MILLIMETRES = 1000.0
_NOTHING = 1e-4  # mm or degrees: the chord of two equal rotations is known to the root of rounding
_SIZES = {"T": (3, 4), "J_g0": (6, 6), "J_g6": (6, 6)}
_WORDS = {"correct": "right", "correct after emendation": "right, emended", "unreadable": "text lost"}
_RUN = "plants/kinematic"
_TURNED = {
    "with both turns": (),
    "without -90° of joint 2": (1,),
    "without 180° of joint 6": (5,),
    "as printed, without both": (1, 5),
}


def equations() -> dict[str, Measured]:
    """Return the numbers of right, wrong and lost equations, and of the configurations in which they are checked."""
    checked = _checked()
    total = counts(checked)
    cells = [cell for name in _SIZES for row in elements(name, "").rows for cell in row[1:]]
    (_, transform), (linear, of_linear), (angular, of_angular) = (
        _readable(checked, rows) for rows in (r"T_\d\d", "J_g._[012]", "J_g._[345]")
    )
    found = {
        "postures": ("configurations in which the table of the arm is checked", _COUNT),
        "samples": ("configurations in which the printed elements are checked", _SAMPLES),
        "all": ("equations", len(checked)),
        "right": ("equations right as printed", total["correct"]),
        "emended": ("equations right after emendation", total["correct after emendation"]),
        "wrong": ("equations wrong as printed", total["wrong as printed"]),
        "lost": ("equations that cannot be read", total["unreadable"]),
        "names": ("equations that only name things", total["definition"]),
        "cells": ("elements without a readable equation", cells.count(_WORDS["unreadable"])),
        "transform_wrong": ("wrong elements of the transform", transform),
        "linear": ("readable equations of the linear rows", linear),
        "linear_wrong": ("wrong ones of the linear rows", of_linear),
        "angular": ("readable equations of the angular rows", angular),
        "angular_wrong": ("wrong ones of the angular rows", of_angular),
        "axes": ("those that are the joint's axis without terms that hold an angle", _axes(checked)),
    }
    return {key: Measured(words, count) for key, (words, count) in found.items()}


def frame_off(runs: Runs, case: str) -> list[Measured]:
    """Return mean and largest distance and mean turn of frame 6 by Table 1 with or without its lost turns."""
    run = runs[_RUN]
    flange = RobotModel(run.urdf, run.config["robot"]["tip"], run.config["gravity"])
    low, high = np.clip(run.model.position_limits, -np.pi, np.pi)
    drawn = np.random.default_rng(0).uniform(low, high, (_COUNT, len(TABLE)))
    true = np.array([flange.tip_pose(q) for q in drawn])
    table = [replace(row, theta=0.0) if index in _TURNED[case] else row for index, row in enumerate(TABLE)]
    poses = frames(drawn, table)[-1]
    distance = np.linalg.norm(poses[:, :3, 3] - _MILLIMETRES * true[:, :3, 3], axis=1)
    chord = np.linalg.norm(poses[:, :3, :3] - true[:, :3, :3], axis=(1, 2))  # 2 sqrt(2) sin(angle / 2)
    angle = np.degrees(2.0 * np.arcsin(np.minimum(chord / np.sqrt(8.0), 1.0)))
    return [
        Measured(f"mean distance of frame 6 {case}", float(distance.mean()), "mm"),
        Measured(f"largest distance of frame 6 {case}", float(distance.max()), "mm"),
        Measured(f"mean turn of frame 6 {case}", float(angle.mean()), "°"),
    ]


def table_one(runs: Runs) -> list[list[str]]:
    """Return the error of frame 6 by Table 1 with and without its lost turns: a row for each case."""
    return [[case, *(number(off.value, rounding=_NOTHING) for off in frame_off(runs, case))] for case in _TURNED]


def elements(name: str, caption: str) -> Table:
    """Return the verdict on each element of a printed matrix, T, J_g0 or J_g6, in its place."""
    rows, columns = _SIZES[name]
    found: dict[tuple[int, int], str] = {}
    for each in _checked():
        for element in (each.entry.emendation or each.entry.printed).elements:
            place = re.fullmatch(rf"{name}_(\d)(\d)", element)
            if place is not None:
                found.setdefault((int(place[1]), int(place[2])), _cell(each, element))
    cells = [[str(row), *(found.get((row, column), "text lost") for column in range(columns))] for row in range(rows)]
    return Table(caption, ["row", *(f"column {column}" for column in range(columns))], cells)


@cache
def _checked() -> list[CheckedEquation]:
    return [each for each in audit("meca500", _SAMPLES) if each.entry.place[0] in "17"]


def _readable(checked: Sequence[CheckedEquation], names: str) -> tuple[int, int]:
    """Return the number of readable equations for elements of such names, and the number of wrong ones."""
    found = [
        each.verdict
        for each in checked
        if each.measured is not None and any(re.match(names, name) for name in each.measured.elements)
    ]
    return len(found), found.count("wrong as printed")


def _axes(checked: Sequence[CheckedEquation]) -> int:
    """Return the number of wrong equations of the angular rows that are right if every bare angle is zero."""
    wrong = {each.entry.id for each in checked if each.verdict == "wrong as printed"}
    found = 0
    for part in parts("meca500"):
        symbols = Check(part, _SAMPLES).symbols
        zeros = {name: 0.0 * values if re.fullmatch(r"theta\d", name) else values for name, values in symbols.items()}
        for entry in part.entries:
            form, right = entry.emendation or entry.printed, entry.corrected
            names = [name for name in form.elements if re.match("J_g._[345]", name)]
            if entry.id in wrong and right is not None and names:
                off = [
                    evaluate(parse(form.elements[name]), zeros) - evaluate(parse(right.elements[name]), symbols)
                    for name in names
                ]
                found += bool(np.abs(off).max() <= entry.tolerance)
    return found


def _cell(checked: CheckedEquation, element: str) -> str:
    if checked.verdict in _WORDS or checked.measured is None:
        return _WORDS.get(checked.verdict, "text lost")
    return f"wrong by up to {number(checked.measured.elements[element], 2)}"
