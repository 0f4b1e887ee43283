"""The findings of the xArm7 report hold with the values of its whole runs, and fall with changed ones."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from changed_values import m, never_failing, texts_without_a_value

import runner.works.xarm7
from runner.works.xarm7 import (
    claims,
    kinematics,
    null_space,
    null_space_cycles,
    null_space_manipulability,
    payload,
    plants,
    rates,
    servo,
    seven_joints,
    three_joints,
    torque_level,
    why_it_failed,
    why_it_failed_columns,
    why_it_failed_motion,
)

_LATE = [(m(late), m(late)) for late in 2 * (0.0105, 7.85e-3, 6.98e-3, 6.54e-3)]
# Each finding with the values, to some digits, that the whole runs give.
FINDINGS = {
    "statements": (
        claims.conclude,
        (7, m(6.0, "1"), m(1.0, "1"), [m(1e-16), m(3.9e-11), m(1.16e-6), m(3.36e-7)], m(1.257e-3), m(1.2566e-3)),
    ),
    "transforms": (kinematics.conclude_forward, (m(6.61e-5), m(0.512))),
    "inverse kinematics": (
        kinematics.conclude_inverse,
        (m(1.52e-5), [m(0.133), m(0.108), m(0.127), m(0.0114), m(0.117)]),
    ),
    "branches": (
        kinematics.conclude_branches,
        (m(1.14, "rad"), [m(-2.1, "rad"), m(-0.579, "rad"), m(-2.1, "rad")], m(3.3e-16), m(8.08e-5, "rad")),
    ),
    "misprint": (three_joints.conclude_misprint, (m(0.60431), m(0.15082), m(0.6043), m(0.1508), 0.643)),
    "reach": (
        three_joints.conclude_reach,
        ([m(1.14, "rad"), m(1.25, "rad")], [m(0.683), m(0.647)], (0.643, 0.6043)),
    ),
    "pseudo-inverse": (
        why_it_failed.conclude,
        (2202, m(1217.0, "1"), m(0.0, "1"), m(1.18, "1"), m(0.0853, "1"), m(1.22e-10, "1")),
    ),
    "columns": (
        why_it_failed_columns.conclude,
        tuple(m(value, "1") for value in (6.8e-16, 6e-16, 1.42, 0.375, 0.0757, 1.29, 0.105, 0.118)),
    ),
    "motion": (
        why_it_failed_motion.conclude,
        (
            *(4, m(0.0, "1"), m(4.0, "1"), m(0.4), m(0.365), m(0.437), m(0.1)),
            *(m(1.1e-14, "rad/s"), m(0.0985, "rad/s"), m(3.14, "rad/s")),
            *(m(8.44e-3), m(2.04e-4), m(6.18e-4), m(1.97e-5), m(1.1e-6)),
        ),
    ),
    "seven joints": (
        seven_joints.conclude,
        (
            *(m(1.1e-6), m(6.98e-3), m(6.981e-3), m(1.16e-6), m(1.1e-6), m(2.3e-8, "rad"), m(0.603, "rad")),
            [m(0.123, "rad/s"), m(0.202, "rad/s"), m(0.195, "rad/s")],
        ),
    ),
    "null space": (
        null_space.conclude,
        (
            *([m(7.88e-5), m(4.57e-6), m(1.44e-8)], m(3.97e-7), [m(7.49e-5), m(8.35e-6), m(3.96e-6)], m(6.31e-7)),
            *(2.5, m(1.32e-3), m(0.031, "s")),
        ),
    ),
    "cycles": (
        null_space_cycles.conclude,
        (
            *(m(0.0122, "rad"), m(0.0121, "rad"), m(0.0608, "rad"), m(1.1e-8, "rad")),
            [("a", m(2.9e-16, "rad")), ("b", m(9.37e-4, "rad")), ("c", m(6.45e-6, "rad"))],
            *(m(4.18e-6), [m(4.17e-6), m(4.19e-6), m(4.26e-6)]),
        ),
    ),
    "manipulability": (
        null_space_manipulability.conclude,
        (
            *(m(0.103, "m³"), m(0.104, "m³"), m(0.0679, "m³"), m(0.0748, "m³")),
            *(m(0.0192, "rad"), m(1.55, "rad"), m(5.7, "s"), m(4.39e-6)),
        ),
    ),
    "rates": (
        rates.conclude,
        (
            *(_LATE, [m(2.62e-5), m(4.92e-6), m(1.09e-6), m(1.64e-7)], [m(1.09e-6), m(1.64e-7)]),
            *([m(5.36e-5), m(5.14e-5)], m(0.093, "s"), [m(1.16e-6), m(3.36e-7)], m(6.98e-3)),
        ),
    ),
    "servo": (
        servo.conclude,
        (
            *(1500.0, m(0.0166), m(0.0164), m(3.68e-4), m(3.33e-3), m(8.5e-3), m(0.075, "s"), m(2e-5), m(1.9e-4)),
            [m(0.0795), m(0.0164), m(3.3e-3)],
        ),
    ),
    "payload": (
        payload.conclude,
        (
            *(
                3.5,
                1e-3,
                [(m(3.09, "kg"), m(4.68, "kg")), (m(3.52, "kg"), m(5.04, "kg"))],
                (m(2.27, "kg"), m(3.74, "kg")),
            ),
            *([m(8.8e-5), m(8.78e-5)], [m(1.33), m(1.34), m(1.2)], [m(87.3, "%"), m(100.0, "%")], [m(1.33), m(0.676)]),
        ),
    ),
    "torques": (
        torque_level.conclude,
        (
            [[m(1.04e-5), m(7.25e-6), m(1.62e-5)], [m(1.03e-5), m(7.16e-6), m(1.47e-5)]],
            [[m(0.0403), m(0.0426)], [m(1.3), m(1.31)]],
            [m(30.3, "N m"), m(30.3, "N m")],
            *([m(2.0, "1"), m(2.0, "1")], [m(0.01, "s"), m(0.01, "s")], [m(23.2, "%"), m(53.6, "%")]),
        ),
    ),
    "plants": (
        plants.conclude,
        ([[m(2.66e-6), m(1.33e-6), m(6.68e-7)], [m(2.66e-6), m(1.33e-6), m(6.68e-7)]], [m(1.27e-3), m(1.03e-4)]),
    ),
}
every_finding = pytest.mark.parametrize("name", FINDINGS)
MODULES = sorted(Path(runner.works.xarm7.__file__).parent.glob("*.py"))


@every_finding
def test_it_holds_with_the_values_of_the_whole_runs(name):
    conclude, values = FINDINGS[name]
    found = conclude(*values)
    assert [condition.text for condition in found.conditions if not condition.holds] == []


@every_finding
def test_a_changed_value_makes_each_condition_fail(name):
    assert never_failing(*FINDINGS[name]) == []


@every_finding
def test_a_missing_value_is_told_as_such(name):
    without = list(texts_without_a_value(*FINDINGS[name]))
    assert any("has no value" in found.text for found in without)
    for found in without:
        assert not re.search(r"\bNone\b|\bnan\b", found.title + found.text)


def calls_of_finding(module: Path) -> Iterator[ast.Call]:
    for node in ast.walk(ast.parse(module.read_text())):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "finding":
            yield node


def words(node: ast.expr) -> Iterator[str]:
    """Yield what is written out of a text, without what is inserted into it."""
    for part in node.values if isinstance(node, ast.JoinedStr) else [node]:
        if isinstance(part, ast.Constant):
            yield str(part.value)


def test_each_finding_of_the_report_has_its_values_here():
    assert sum(len(list(calls_of_finding(module))) for module in MODULES) == len(FINDINGS)
    assert not [module.name for module in MODULES if re.search(r'Notice\(\s*"finding"', module.read_text())]


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.stem)
def test_numbers_in_a_finding_s_words_are_inserted_and_no_branch_chooses_them(module):
    for call in calls_of_finding(module):
        title, text, *_ = call.args
        assert not [each for node in (title, text) for each in words(node) if re.search(r"\d", each)]
        assert not [
            node for each in (title, text) for node in ast.walk(each) if isinstance(node, ast.IfExp | ast.BoolOp)
        ]
