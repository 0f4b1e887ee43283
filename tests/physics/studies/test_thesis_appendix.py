"""The appendix of the thesis: read, counted, and held against the true torques."""

import re
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest

from runner.audit.entry import entries, form_values
from runner.audit.evaluation import evaluate_all
from runner.studies.thesis.equations.appendix import Harmonic, canonical, parse, read_appendix
from runner.studies.thesis.equations.derivations import thesis_appendix
from runner.studies.thesis.equations.derivations.thesis import symbols
from runner.studies.thesis.equations.derivations.thesis_appendix import appendix_damages, damages, true_series
from runner.studies.thesis.equations.derivations.thesis_arms import COMBINED

DYNAMICS = COMBINED.audited.derivations("model.dynamics")
TERMS = (1011, 592, 427, 359, 325, 239)
GROUPS = (26, 25, 24, 19, 21, 20)  # with gravity, which joint 1 does not feel
DAMAGED = (7, 2, 2, 1, 1, 106)


def term(text):
    (row,) = parse([text]).terms
    return row


def evaluate(terms, q, dq, ddq):
    """Return the torques, (T, 6) in N m, that terms add up to: torque (1 to 6), factor, harmonic, coefficient."""
    torques = np.zeros_like(q)
    for torque, factor, harmonic, coefficient in terms:
        phase = q @ np.array(harmonic.multiples, dtype=float)
        value = coefficient * (np.sin(phase) if harmonic.function == "sin" else np.cos(phase))
        torques[:, torque - 1] += value * motion(factor, dq, ddq)
    return torques


def motion(factor, dq, ddq):
    """Return the value of a group's factor, such as "qv1*qv2", shape (T,)."""
    value = np.ones(len(dq))
    for name in re.findall(r"q[va]\d(?:\^2)?", factor):
        joint = int(name[2]) - 1
        value = value * (dq[:, joint] if name[1] == "v" else ddq[:, joint]) ** (2 if name.endswith("^2") else 1)
    return value


def factors(text):
    return [term.factor for term in parse([text]).terms]


def emendations(text):
    return [emendation.kind for emendation in parse([text]).emendations]


# Reading.


def test_a_term():
    found = term("(-3/8000*sin(2*q4-q3))*qv1*qv2")
    assert found.factor == "qv1*qv2"
    assert found.harmonic == Harmonic("sin", (0, 0, 1, -2, 0, 0))
    assert found.coefficient == Fraction(3, 8000)  # -sin(2 q4 - q3) is sin(q3 - 2 q4)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("(1/2*sin(q2)+1/4)*qv3^2", ["qv3^2"] * 2),
        ("1/2*sin(q2)+(cos(q3)-2)*qa4", ["gravity", "qa4", "qa4"]),
        ("(1/2*sin(q2))*qa1+1/1000*qa6-1/5*cos(q2)", ["qa1", "qa6", "gravity"]),
        ("(sin(q2))*qv1^2-1/1000*cos(q6)*qv6^2", ["qv1^2", "qv6^2"]),
    ],
)
def test_groups(text, expected):
    assert factors(text) == expected
    assert emendations(text) == []


@pytest.mark.parametrize(
    ("text", "expected", "emended"),
    [
        ("(sin(q2))*qv1*qv5+-1/4*cos(q6)+sin(q3))*qv3*qv6", ["qv1*qv5", "qv3*qv6", "qv3*qv6"], ["bracket put in"]),
        ("(sin(q2)-cos(q3)*qa3+(sin(q4))*qa4", ["qa3", "qa3", "qa4"], ["bracket put in"]),
        ("(sin(q2))*q3^2+(sin(q2))*q1", ["qv3^2", "qa1"], ["v or a put in"] * 2),
        ("(sin(q2))*q2*q3", ["qv2*qv3"], ["v or a put in"]),
        ("(sin(q2))*qv^2*qv^6", ["qv2*qv6"], ["raised number put down"]),
        ("(sin(q2))*qv^3^2", ["qv3^2"], ["raised number put down"]),
        ("(sin(2q4+q2))*qa1", ["qa1"], ["product sign put in"]),
        ("(sin(q2)4))*qa5", ["qa5"], ["unreadable"] * 2),
    ],
)
def test_damage_is_mended_and_recorded(text, expected, emended):
    assert factors(text) == expected
    assert emendations(text) == emended


def test_a_product_sign_put_in_makes_no_other_term():
    assert term("(sin(2q4+q2))*qa1").harmonic == term("(sin(2*q4+q2))*qa1").harmonic


@pytest.mark.parametrize("function", ["sin", "cos"])
def test_equal_functions_have_one_form(function):
    multiples, q = (0, -1, 2, 0, 1, -2), np.random.default_rng(0).normal(size=(5, 6))
    harmonic, value = canonical(function, multiples, Fraction(3))
    opposite, other = canonical(function, tuple(-m for m in multiples), Fraction(-3 if function == "sin" else 3))
    assert (harmonic, value) == (opposite, other)
    expected = 3.0 * getattr(np, function)(q @ np.array(multiples))
    found = evaluate([(2, "gravity", harmonic, float(value))], q, q, q)
    np.testing.assert_allclose(found[:, 1], expected, atol=1e-14)
    np.testing.assert_array_equal(found[:, [0, 2, 3, 4, 5]], 0.0)


def test_factors_have_their_motion():
    dq, ddq = np.arange(1.0, 7.0)[None], 10.0 * np.arange(1.0, 7.0)[None]
    found = {factor: motion(factor, dq, ddq)[0] for factor in ("gravity", "qv2^2", "qv2*qv5", "qa3")}
    assert found == {"gravity": 1.0, "qv2^2": 4.0, "qv2*qv5": 10.0, "qa3": 30.0}


# Counting.


def test_terms_and_groups_of_the_text():
    terms = read_appendix().terms
    rows = [[term for term in terms if term.torque == torque] for torque in range(1, 7)]
    assert tuple(map(len, rows)) == TERMS
    assert tuple(len({term.factor for term in row}) for row in rows) == GROUPS
    assert len(terms) == 2953


def test_no_position_of_joint_1_appears():
    assert {term.harmonic.multiples[0] for term in read_appendix().terms} == {0}


def test_emendations_of_the_text():
    assert Counter(emendation.kind for emendation in read_appendix().emendations) == {
        "product sign put in": 183,
        "raised number put down": 19,
        "v or a put in": 11,
        "bracket put in": 7,
        "unreadable": 2,
    }


# True coefficients.


def test_true_terms_are_one_more_than_printed_ones():
    series = true_series()
    assert tuple(sum(len(v) for (row, _), v in series.items() if row == torque) for torque in range(1, 7)) == (
        *TERMS[:3],
        TERMS[3] + 1,
        *TERMS[4:],
    )


def test_the_true_series_is_the_torque():
    values = symbols(50, np.random.default_rng(5))
    q, dq, ddq = COMBINED.q(values), COMBINED.dq(values), COMBINED.ddq(values)
    terms = [(torque, factor, h, c) for (torque, factor), found in true_series().items() for h, c in found.items()]
    torques = evaluate(terms, q, dq, ddq)
    np.testing.assert_allclose(torques, DYNAMICS.first(values)["tau"], atol=1e-12)


def test_known_torques():
    values = {f"q{i}": np.array([x]) for i, x in enumerate((0.3, -0.5, 0.7, 0.2, -0.4, 0.9), start=1)}
    values |= {f"dq{i}": np.array([i / 10]) for i in range(1, 7)} | {
        f"ddq{i}": np.array([0.7 - i / 10]) for i in range(1, 7)
    }
    expected = [0.756871, 17.639557, -1.458317, 0.001641, 0.132384, -0.057832]
    for derivation in (DYNAMICS.first, DYNAMICS.second):
        np.testing.assert_allclose(derivation(values)["tau"][0], expected, atol=1e-6)


# Damage.


def test_what_is_damaged():
    kinds = Counter(damage.kind for damage in appendix_damages())
    assert kinds == {"coefficient": 116, "argument": 2, "lost": 1}
    assert tuple(sum(d.torque == torque for d in appendix_damages()) for torque in range(1, 7)) == DAMAGED


def test_every_damaged_coefficient_has_zeros_too_many():
    for damage in appendix_damages():
        if damage.kind == "coefficient":
            assert re.fullmatch("10+", str(damage.true / damage.read.coefficient)), damage.read.text


def test_the_damaged_arguments_are_a_digit_and_a_sign():
    found = {d.read.text: d.harmonic.multiples for d in appendix_damages() if d.kind == "argument"}
    assert found == {
        "-1/32000*sin(2*q6+2*q5-*q4+2*q3+2*q2)": (0, 2, 2, -2, 2, 2),
        "-1/4000*sin(2*q6+2*q5+q3+q2+q4)": (0, 1, 1, -1, 2, 2),
    }


def test_the_lost_term():
    (lost,) = [damage for damage in appendix_damages() if damage.kind == "lost"]
    assert (lost.torque, lost.factor, lost.harmonic.function) == (4, "qv1*qv3", "sin")
    assert (lost.harmonic.multiples, lost.true) == ((0, 1, 1, 0, -2, 0), Fraction(-1, 2000))


@pytest.mark.parametrize(("old", "new", "kind"), [("3/8000", "3/800", "coefficient"), ("sin", "cos", "argument")])
def test_a_planted_misprint_is_found(old, new, kind):
    text = "(3/8000*sin(2*q4+q3+q2)-1/400*cos(q5))*qv2^2"
    series = {(1, "qv2^2"): {term.harmonic: float(term.coefficient) for term in parse([text]).terms}}
    assert damages(parse([text]), series) == []
    (damage,) = damages(parse([text.replace(old, new, 1)]), series)
    assert (damage.kind, damage.true) == (kind, Fraction(3, 8000))


def test_a_term_printed_twice_is_right_once():
    series = {(1, "qa1"): {term.harmonic: float(term.coefficient) for term in parse(["(1/4*cos(q5))*qa1"]).terms}}
    (damage,) = damages(parse(["(1/4*cos(q5)+1/4*cos(q5))*qa1"]), series)
    assert (damage.kind, damage.true, damage.harmonic) == ("argument", 0, None)


# What the audit says of it.


@pytest.mark.parametrize("torque", range(1, 7))
def test_the_torques_as_read_and_mended(torque):
    part, entry = next((part, entry) for part, entry in entries("thesis") if entry.id == f"thesis-appendix-{torque}")
    whole = entry.as_read(part.source)
    assert len(whole.printed.elements) == GROUPS[torque - 1] + 1
    values = symbols(50, np.random.default_rng(0))
    true = DYNAMICS.first(values)[f"tau_{torque}"]
    read, emended = (
        form_values(whole, form, values, {})[f"tau_{torque}"] for form in (whole.printed, whole.emendation)
    )
    assert np.abs(read - true).max() > entry.tolerance * 1e5
    np.testing.assert_allclose(emended, true, atol=1e-12)


@pytest.mark.parametrize("torque", range(1, 7))
def test_expressions_have_every_term(torque):
    """As read, they add up to what the terms add up to, evaluated one by one."""
    values = symbols(20, np.random.default_rng(1))
    terms = [(term.torque, term.factor, term.harmonic, float(term.coefficient)) for term in read_appendix().terms]
    expected = evaluate(terms, *COMBINED.audited.motion(values))[:, torque - 1]
    texts = getattr(thesis_appendix, f"read_{torque}")()
    np.testing.assert_allclose(evaluate_all(texts, values)[f"tau_{torque}"], expected, atol=1e-12)
