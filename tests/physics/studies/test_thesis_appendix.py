"""The appendix of the thesis: its text as read, and its emendations."""

import re
from fractions import Fraction

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.papers.audit.entry import Entry, entries, form_values
from runner.papers.studies.thesis.equations.derivations import thesis_appendix
from runner.papers.studies.thesis.equations.derivations.thesis import symbols
from runner.papers.studies.thesis.equations.derivations.thesis_appendix import elements
from runner.papers.studies.thesis.equations.derivations.thesis_arms import COMBINED

DYNAMICS = COMBINED.audited.derivations("model.dynamics")
TORQUES = range(1, 7)
TERMS = (1011, 592, 427, 359, 325, 239)
GROUPS = (26, 25, 24, 19, 21, 20)  # with gravity, which joint 1 does not feel
LAST = "+ 1/4000*cos(-q6-2*q5-2*q4+q3+q2)"  # of dq1 dq3 in torque 4
EMENDED = (7, 2, 2, 1, 1, 106)
COEFFICIENT = re.compile(r"([+-]? ?)(\d+(?:/\d+)?)(.*)")


def read(torque):
    """Return the groups of a torque, as read."""
    return {name: text for name, text in getattr(thesis_appendix, f"read_{torque}")().items() if "tau" not in name}


def appendix(torque):
    part, entry = next((part, entry) for part, entry in entries("thesis") if entry.id == f"thesis-appendix-{torque}")
    return part, entry


def replaced(torque):
    replace = appendix(torque)[1].emendation.replace
    return [(old, new) for texts in replace.values() for old, new in texts.items()]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("(1/2*sin(q2)+1/4)*qv3^2", {"h_33": "1/2*sin(q2) + 1/4", "tau": "h_33*dq3^2"}),
        (
            "1/2*sin(q2)+(cos(q3)-2)*qa4",
            {"g": "1/2*sin(q2)", "a_4": "cos(q3) - 2", "tau": "g + a_4*ddq4"},
        ),
        (
            "(1/2*sin(q2))*qa1+1/1000*qa6-1/5*cos(q2)",
            {"a_1": "1/2*sin(q2)", "a_6": "1/1000", "g": "- 1/5*cos(q2)", "tau": "a_1*ddq1 + a_6*ddq6 + g"},
        ),
        (
            "(sin(q2))*qv1*qv5-1/1000*cos(q6)*qv6^2",
            {"h_15": "sin(q2)", "h_66": "- 1/1000*cos(q6)", "tau": "h_15*dq1*dq5 + h_66*dq6^2"},
        ),
    ],
)
def test_groups(text, expected):
    assert elements(text) == expected


@pytest.mark.parametrize(
    ("damaged", "sound"),
    [
        ("(sin(q2))*qv1*qv5+-1/4*cos(q6)+sin(q3))*qv3*qv6", "(sin(q2))*qv1*qv5+(-1/4*cos(q6)+sin(q3))*qv3*qv6"),
        ("(sin(q2)-cos(q3)*qa3+(sin(q4))*qa4", "(sin(q2)-cos(q3))*qa3+(sin(q4))*qa4"),
        ("(sin(q2))*q3^2+(sin(q2))*q1", "(sin(q2))*qv3^2+(sin(q2))*qa1"),
        ("(sin(q2))*q2*q3", "(sin(q2))*qv2*qv3"),
        ("(sin(q2))*qv^2*qv^6", "(sin(q2))*qv2*qv6"),
        ("(sin(q2))*qv^3^2", "(sin(q2))*qv3^2"),
        ("(sin(2q4+q2))*qa1", "(sin(2*q4+q2))*qa1"),
        ("(sin(2*q5-*q4))*qa1", "(sin(2*q5-q4))*qa1"),
        ("(sin(q2)4))*qa5", "(sin(q2))*qa5"),
    ],
)
def test_damage_is_emended_to_read_a_row(damaged, sound):
    assert elements(damaged) == elements(sound)


@pytest.mark.parametrize("torque", TORQUES)
def test_no_term_of_the_text_is_lost(torque):
    groups = read(torque)
    assert len(groups) == GROUPS[torque - 1]
    terms = [term for text in groups.values() for term in re.split(r" (?=[+-] )", text)]
    assert len(terms) == TERMS[torque - 1]
    words = re.compile(r"\d+/\d+|sin|cos")
    assert sorted(words.findall(thesis_appendix._rows()[torque - 1])) == sorted(words.findall(" ".join(terms)))


def test_no_position_of_joint_1_appears():
    assert not any("q1" in text for torque in TORQUES for text in read(torque).values())


def test_known_torques():
    values = {f"q{i}": np.array([x]) for i, x in enumerate((0.3, -0.5, 0.7, 0.2, -0.4, 0.9), start=1)}
    values |= {f"dq{i}": np.array([i / 10]) for i in TORQUES} | {f"ddq{i}": np.array([0.7 - i / 10]) for i in TORQUES}
    expected = [0.756871, 17.639557, -1.458317, 0.001641, 0.132384, -0.057832]
    for derivation in (DYNAMICS.first, DYNAMICS.second):
        np.testing.assert_allclose(derivation(values)["tau"][0], expected, atol=1e-6)


# Emendations.


def test_every_coefficient_that_is_emended_has_zeros_too_many():
    assert tuple(len(replaced(torque)) for torque in TORQUES) == EMENDED
    others = []
    for old, new in (each for torque in TORQUES for each in replaced(torque)):
        (sign, before, rest), (sign_after, after, rest_after) = (
            COEFFICIENT.match(text).groups() for text in (old, new)
        )
        if (sign, rest) != (sign_after, rest_after):
            others.append((old, new))
            continue
        assert re.fullmatch("10+", str(Fraction(after) / Fraction(before))), old
    assert others == [  # a digit, a lost term, and a sign
        ("- 1/32000*sin(2*q6+2*q5-q4+2*q3+2*q2)", "- 1/32000*sin(2*q2 + 2*q3 - 2*q4 + 2*q5 + 2*q6)"),
        (LAST, f"{LAST} - 1/2000*sin(q2 + q3 - 2*q5)"),
        ("- 1/4000*sin(2*q6+2*q5+q3+q2+q4)", "- 1/4000*sin(q2 + q3 - q4 + 2*q5 + 2*q6)"),
    ]


@pytest.mark.parametrize("torque", TORQUES)
def test_the_torques_as_read_and_emended(torque):
    part, entry = appendix(torque)
    whole = entry.as_read(part.source)
    values = symbols(50, np.random.default_rng(0))
    true = DYNAMICS.first(values)[f"tau_{torque}"]
    printed, emended = (
        form_values(whole, form, values, {})[f"tau_{torque}"] for form in (whole.printed, whole.emendation)
    )
    assert np.abs(printed - true).max() > entry.tolerance * 1e5
    np.testing.assert_allclose(emended, true, atol=1e-12)


@pytest.mark.parametrize("old", ["q1", "missing"])
def test_a_part_that_is_not_once_in_its_element_is_not_replaced(old):
    printed = {"elements": {"x": "q1 + q1"}}
    emended = {"why": "a letter", "replace": {"x": {old: "q2"}}}
    entry = Entry(id="a", number="1", place="p", title="t", printed=printed, emendation=emended)
    count = {"q1": 2, "missing": 0}[old]
    with pytest.raises(RunnerError, match=f"replace: '{old}' is {count} times in 'x' as printed; allowed: 1"):
        entry.as_read(None)
