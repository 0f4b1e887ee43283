"""Reference derivations of audited equations: the two of each agree, and known values come out."""

import numpy as np
import pytest

from runner.papers.audit.derivations import derivative, jacobian_by_differences, rotation
from runner.papers.audit.entry import entries, parts
from runner.papers.audit.evaluation import evaluate
from runner.papers.audit.sources import derivation_of, sources
from runner.papers.audit.verdict import Check, error
from runner.papers.expressions.parser import parse
from runner.papers.studies.meca500.equations.derivations import meca500
from runner.papers.studies.xarm7.equations.derivations import xarm7, xarm7_inverse

SAMPLES = 40


@pytest.mark.parametrize("source", sources())
def test_the_two_ways_to_every_truth_agree(source):
    for part in parts(source):
        check = Check(part, SAMPLES)
        for entry in part.entries:
            found = check.derivations(entry) if entry.derivation else None
            first, second = (found.first(check.symbols), found.second(check.symbols)) if found else ({}, {})
            assert set(first) == set(second), entry.id
            for element, expected in first.items():
                size = max(1.0, float(np.abs(expected).max()))
                assert error(second[element], expected, entry.unit).max() <= 2e-5 * size, f"{entry.id}: {element}"


@pytest.mark.parametrize("source", sources())
def test_a_tolerance_is_small_beside_what_it_measures(source):
    for part in parts(source):
        check = Check(part, SAMPLES)
        for entry in part.entries:
            if entry.derivation:
                largest = max(
                    float(np.abs(true).max()) for true in check.derivations(entry).first(check.symbols).values()
                )
                assert entry.tolerance <= 3e-4 * max(1.0, largest), entry.id


def test_the_xarm7_tip_at_a_known_configuration():
    q = np.array([[0.1, 0.75, 0.2, 1.5, -0.3, 0.75, 0.4]])
    np.testing.assert_allclose(xarm7.pose(q)[0, :3, 3], [58.447967, 15.969098, 15.779577], atol=1e-6)


def test_the_meca500_tip_at_known_configurations():
    q = np.array([[0.0] * 6, [0.1, 0.2, -0.3, 0.4, 0.5, -0.6]])
    expected = [[190, 0, 308], [204.299956, 33.632783, 292.475814]]
    np.testing.assert_allclose(meca500.pose(q)[:, :3, 3], expected, atol=1e-6)
    np.testing.assert_allclose(meca500.BY_MODEL.pose(q)[:, :3, 3], expected, atol=1e-6)
    np.testing.assert_allclose(meca500.pose(q)[0, :3, :3], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-12)


def test_the_inverse_kinematics_mended_reaches_its_target():
    y = np.linspace(-20, 20, 9)
    tip = xarm7.BY_MODEL.pose(xarm7_inverse.full(xarm7_inverse.solve(xarm7_inverse.points(y))))[:, :3, 3]
    np.testing.assert_allclose(tip, xarm7_inverse.points(y), atol=1e-10)


def test_differences_are_exact_for_a_polynomial_of_fourth_degree():
    q = np.random.default_rng(0).normal(size=(20, 2))
    found = derivative(lambda x: x[:, 0] ** 4 - 3 * x[:, 0] ** 3 * x[:, 1], q, 0)
    np.testing.assert_allclose(found, 4 * q[:, 0] ** 3 - 9 * q[:, 0] ** 2 * q[:, 1], atol=1e-9)


def test_the_angular_rows_of_a_rotation_about_an_axis_are_the_axis():
    J = jacobian_by_differences(lambda q: rotation("y", q[:, 0]), np.array([[0.3], [2.0]]))
    np.testing.assert_allclose(J[:, 3:, 0], [[0, 1, 0]] * 2, atol=1e-11)


def test_the_printed_angular_rows_of_the_meca500_are_derivatives_of_summed_angles():
    """Statements of the findings on these rows, in the base frame and in frame 6."""
    part = next(part for part in parts("meca500") if part.entries[0].number == "Table 1, row 1")
    values = derivation_of(part.source, part.symbols)(SAMPLES, np.random.default_rng(2))
    q = meca500.positions(values)

    def axes(angles):
        return np.stack([frame[:, :3, 2] for frame in meca500.frames(angles)], axis=2)

    def axes_6(angles):
        return meca500.pose(angles)[:, :3, :3].transpose(0, 2, 1) @ axes(angles)

    base = np.stack([derivative(lambda a: np.einsum("tij,tj->ti", axes(a), a), q, joint) for joint in range(6)], axis=2)
    own = axes_6(q) + sum(q[:, k, None, None] * derivative(axes_6, q, k) for k in range(6))
    checked = 0
    for _, entry in entries("meca500"):
        form = entry.emendation or entry.printed
        for name, text in form.elements.items():
            if entry.corrected is None or not name.startswith(("J_g0_", "J_g6_")) or int(name[5]) < 3:
                continue
            row, column = int(name[5]) - 3, int(name[6])
            expected = (base if name.startswith("J_g0") else own)[:, row, column]
            np.testing.assert_allclose(evaluate(parse(text), values), expected, atol=1e-9)
            checked += 1
    assert checked == 21


def test_what_is_emended_in_the_xarm7_report_keeps_every_sign_but_brackets():
    def without_brackets(text):
        return "".join(text.replace("…", "").split()).translate(str.maketrans("", "", "()."))

    emended = [entry for _, entry in entries("xarm7") if entry.emendation]
    assert len(emended) == 11
    for entry in emended:
        name = entry.number
        assert without_brackets(entry.emendation.elements[name]) == without_brackets(entry.printed.elements[name])
