"""A user's own formulas against the model of a robot: right ones, planted errors and bad input."""

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.papers.audit.model_derivations import by_model
from runner.papers.audit.own_formulas import QUANTITIES, compare

MASS = """
elements:
  M_11: (c2 - sin(q2 + q3))^2 + c2^2
  M_22: 3 - 2*s3
  M_23: 1 - s3
  M_33: 1
  M_12: 0
"""
JACOBIAN = """
symbols: {s23: sin(q2 + q3), c23: cos(q2 + q3)}
elements:
  J_11: c1*(s23 - c2)
  J_21: s1*(s23 - c2)
  J_32: c2 - s23
  J_33: -s23
  J_42: c1
  J_53: s1
"""


@pytest.fixture
def formulas(tmp_path):
    def write(text):
        path = tmp_path / "own.yaml"
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize(("quantity", "text"), [("mass-matrix", MASS), ("jacobian", JACOBIAN)], ids=["M", "J"])
def test_right_formulas_agree(macro, formulas, quantity, text):
    assert all(each.largest < 1e-12 for each in compare(macro, quantity, formulas(text), 200))


def test_gravity_and_position(macro, formulas):
    text = "elements: {G_1: 0, G_2: 19.62*c2 - 9.81*sin(q2 + q3), G_3: -9.81*sin(q2 + q3)}"
    assert all(each.largest < 1e-12 for each in compare(macro, "gravity", formulas(text), 200))
    text = "elements: {P_x: s1*(sin(q2 + q3) - c2), P_z: cos(q2 + q3) + s2}"
    assert all(each.largest < 1e-12 for each in compare(macro, "position", formulas(text), 200))


def test_a_wrong_formula_is_measured_where_it_is_worst(macro, formulas):
    (found,) = compare(macro, "gravity", formulas("elements: {G_2: 19.62*c2 - 9.81*s2}"), 500)
    q = found.at
    assert found.largest == pytest.approx(abs(found.found - found.true))
    assert found.found == pytest.approx(19.62 * np.cos(q[1]) - 9.81 * np.sin(q[1]))
    assert found.true == pytest.approx(macro.gravity_torque(q)[1])
    assert 0 < found.typical < found.largest <= 2 * 9.81
    assert found.instead == ""


def test_a_column_in_the_wrong_place_is_recognised(macro, formulas):
    found = compare(macro, "jacobian", formulas(JACOBIAN.replace("J_33: -s23", "J_33: c2 - s23")), 100)
    assert [each.instead for each in found if each.largest > 1e-6] == ["J_32"]
    found = compare(macro, "jacobian", formulas("elements: {J_53: -s1}"), 100)
    assert [each.instead for each in found] == ["-J_52"]


def test_every_quantity_names_its_elements(mini):
    q = np.zeros((1, 3))
    found = {name: by_model(mini).named(name.replace("-", "_"), q, q, q).values() for name in QUANTITIES}
    counts = {name: sum(each.ndim == 1 for each in values) for name, values in found.items()}
    assert counts == {"position": 3, "jacobian": 18, "mass-matrix": 9, "gravity": 3}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("elements: {J_99: 1}", r"jacobian has no element 'J_99'.*; elements: J_11 to J_63"),
        ("elements: {J_11: s4}", r"own.yaml, J_11, position 1: no name 's4' \(did you mean s3\?\)"),
        ("elements: {J_11: (c1}", "own.yaml, J_11, position 1: .*'\\(' was never closed"),
        ("elements: {J_11: q1.real}", "position 1: is not arithmetic"),
        ("elements: {J_11: exec(q1)}", "not a function that can be called"),
        ("elements: {J_11: 1/(q1 - q1)}", "division by zero at sample 1 \\(q1 = "),
        ("elements: {J_11: [1]}", r"elements.J_11: is \[1\]; allowed: an expression or a number"),
        ("elements: {J_11: yes}", "elements.J_11: is True; allowed"),
        ("elements: [J_11]", "own.yaml: elements: Input should be a valid dictionary"),
        ("symbols: {a: b}\nelements: {J_11: a}", "own.yaml, a, position 1: no name 'b'"),
        ("J_11: 1", "own.yaml: elements: Field required"),
        ("elements: {J_11: 1}\nother: 2", "own.yaml: other: unknown key"),
        ("a: [", "cannot read .*own.yaml"),
        ("!!python/object/apply:os.system [ls]", "cannot read .*own.yaml"),
    ],
)
def test_bad_input_is_told(macro, formulas, text, message):
    with pytest.raises(RunnerError, match=message):
        compare(macro, "jacobian", formulas(text), 10)


def test_a_file_that_is_not_there_is_told(macro, tmp_path):
    with pytest.raises(RunnerError, match=r"cannot read .*none.yaml"):
        compare(macro, "jacobian", tmp_path / "none.yaml", 10)
