"""Verdicts: planted errors, repairs, angles and missing numbers against the verdict that each must give."""

import numpy as np
import pytest

from runner.audit.entry import Entry, Form, parts
from runner.audit.verdict import AuditError, Judge

RIGHT = "l1 + l2*c2"
TRUTH = {"truth": "xarm7.tip", "unit": "cm"}


def entry(printed, name="P_ez", **changes):
    return Entry.model_validate(
        {"id": "x", "number": "1", "place": "p", "title": "t", "printed": {"elements": {name: printed}}}
        | TRUTH
        | changes
    )


def elements(text, name="P_ez"):
    return {"elements": {name: text}}


@pytest.fixture(scope="module")
def judge():
    return Judge(parts("xarm7")[0], samples=50)


@pytest.fixture(scope="module")
def right():
    """The tip's height, corrected."""
    return next(e for e in parts("xarm7")[0].entries if e.number == "P_ez").corrected.elements["P_ez"]


def test_a_right_form_is_correct(judge, right):
    judged = judge.judge(entry(right))
    assert judged.verdict == "correct"
    assert judged.measured.largest < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "size"),
    [("l1 + ", "l1 - ", 2 * 29.3), ("l1 + ", "l1 + 0.001 + ", 0.001), ("l2*cos(q2)", "l2*cos(q2 + 0.01)", 0.293)],
)
def test_a_planted_error_is_found_in_both_ways_and_measured(judge, right, old, new, size):
    assert old in right
    judged = judge.judge(entry(right.replace(old, new, 1), corrected=elements(right)))
    assert judged.verdict == "wrong as printed"
    assert judged.measured.largest == pytest.approx(size, rel=0.05)
    assert judged.second.largest == pytest.approx(judged.measured.largest, rel=1e-6)
    assert 0 < judged.measured.typical <= judged.measured.largest


@pytest.mark.parametrize("number", ["A_14", "A_23", "A_31"])
@pytest.mark.parametrize(("old", "new"), [("s4", "s5"), (" - ", " + "), ("c2", "s2")])
def test_an_error_planted_in_any_right_element_is_found(number, old, new):
    part = parts("xarm7")[0]
    printed = next(e for e in part.entries if e.number == number)
    text = printed.printed.elements[number]
    planted = printed.model_copy(
        update={"printed": elements_form(number, text.replace(old, new, 1)), "corrected": printed.printed}
    )
    assert Judge(part, 50).judge(planted).verdict == "wrong as printed"


def elements_form(name, text):
    return Entry.model_validate(entry(text, name).model_dump()).printed


def test_a_form_that_cannot_be_read_is_unreadable_or_mended(judge, right):
    assert judge.judge(entry("(" + right)).verdict == "unreadable"
    mended = judge.judge(entry("(" + right, repair={"why": "a bracket", **elements(right)}))
    assert mended.verdict == "correct after repair"


def test_a_form_that_is_still_wrong_after_repair_is_wrong(judge, right):
    wrong = right.replace("l1 + ", "")
    judged = judge.judge(entry("(" + wrong, repair={"why": "a bracket", **elements(wrong)}, corrected=elements(right)))
    assert judged.verdict == "wrong as printed"
    assert judged.measured.largest == pytest.approx(26.7)


@pytest.mark.parametrize(
    ("printed", "changes", "message"),
    [
        ("l1", {}, "has no correction"),
        ("l1", {"corrected": elements("l2")}, "the correction is wrong"),
        ("RIGHT", {"corrected": elements("l2")}, "is corrected, but its verdict is 'correct'"),
        ("RIGHT", {"repair": {"why": "none", **elements("l2")}}, "is repaired, but holds as it stands"),
        ("l9", {}, "no name 'l9'"),
        ("l1/0", {}, "division by zero"),
    ],
)
def test_an_entry_that_contradicts_itself_is_our_fault(judge, right, printed, changes, message):
    with pytest.raises(AuditError, match=message):
        judge.judge(entry(right if printed == "RIGHT" else printed, **changes))


def test_an_element_without_truth_is_our_fault(judge):
    with pytest.raises(AuditError, match="no truth for P_other"):
        judge.judge(entry("l1", name="P_other"))


def test_angles_are_compared_the_short_way_round():
    part = next(part for part in parts("xarm7") if part.symbols == "xarm7_inverse.symbols")
    judge = Judge(part, 50)
    turned = entry("atan2(P_ey, P_ex) + 2*3.141592653589793", "q1", truth="xarm7_inverse.joints", unit="rad")
    assert judge.judge(turned).verdict == "correct"


def test_a_value_that_is_no_number_is_an_error_without_bound():
    part = next(part for part in parts("xarm7") if part.path.name == "5_seven_joints.yaml")
    with np.errstate(all="ignore"):
        judged = Judge(part, 200).judge(part.entries[0])
    assert judged.verdict == "wrong as printed"
    assert judged.measured.largest > 1


@pytest.mark.parametrize(
    ("number", "old", "new"),
    [
        ("(3.27)", "transpose(inverse(J)) @ M", "inverse(J) @ M"),
        ("(3.28)", "- Lambda", "+ Lambda"),
        ("(3.32)", "+ p", "- p"),
        ("ẍ = F*", "k_p", "k_v"),
    ],
)
def test_an_equation_of_matrices_is_judged_from_its_text(number, old, new):
    part = next(part for part in parts("thesis") if part.path.name == "3_3.yaml")
    right = next(entry for entry in part.entries if entry.number == number)
    assert Judge(part, 20).judge(right).verdict == "correct"
    texts = {name: text.replace(old, new, 1) for name, text in right.printed.elements.items()}
    assert texts != right.printed.elements
    spoilt = right.model_copy(update={"printed": Form(elements=texts), "corrected": right.printed})
    assert Judge(part, 20).judge(spoilt).verdict == "wrong as printed"
