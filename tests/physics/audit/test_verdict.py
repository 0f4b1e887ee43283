"""Verdicts: planted errors, emendations, angles and missing numbers against the verdict that each must give."""

import numpy as np
import pytest

from runner.papers.audit.entry import Emendation, Entry, Printed, entries, parts
from runner.papers.audit.sources import source_of, sources
from runner.papers.audit.verdict import AuditError, Check

RIGHT = "l1 + l2*c2"
DERIVATION = {"derivation": "xarm7.tip", "unit": "cm"}


def entry(printed, name="P_ez", **changes):
    return Entry.model_validate(
        {"id": "x", "number": "1", "place": "p", "title": "t", "printed": {"elements": {name: printed}}}
        | DERIVATION
        | changes
    )


def elements(text, name="P_ez"):
    return {"elements": {name: text}}


@pytest.fixture(scope="module")
def check():
    return Check(parts("xarm7")[0], samples=50)


@pytest.fixture(scope="module")
def right():
    """The tip's height, corrected."""
    return next(e for e in parts("xarm7")[0].entries if e.number == "P_ez").corrected.elements["P_ez"]


def test_a_right_form_is_correct(check, right):
    checked = check.check(entry(right))
    assert checked.verdict == "correct"
    assert checked.measured.largest < 1e-9


@pytest.mark.parametrize(
    ("old", "new", "size"),
    [("l1 + ", "l1 - ", 2 * 29.3), ("l1 + ", "l1 + 0.001 + ", 0.001), ("l2*cos(q2)", "l2*cos(q2 + 0.01)", 0.293)],
)
def test_a_planted_error_is_found_in_both_ways_and_measured(check, right, old, new, size):
    assert old in right
    checked = check.check(entry(right.replace(old, new, 1), corrected=elements(right)))
    assert checked.verdict == "wrong as printed"
    assert checked.measured.largest == pytest.approx(size, rel=0.05)
    assert checked.second.largest == pytest.approx(checked.measured.largest, rel=1e-6)
    assert 0 < checked.measured.typical <= checked.measured.largest


@pytest.mark.parametrize("number", ["A_14", "A_23", "A_31"])
@pytest.mark.parametrize(("old", "new"), [("s4", "s5"), (" - ", " + "), ("c2", "s2")])
def test_an_error_planted_in_any_right_element_is_found(number, old, new):
    part = parts("xarm7")[0]
    printed = next(e for e in part.entries if e.number == number)
    text = printed.printed.elements[number]
    planted = printed.model_copy(
        update={"printed": elements_form(number, text.replace(old, new, 1)), "corrected": printed.printed}
    )
    assert Check(part, 50).check(planted).verdict == "wrong as printed"


def elements_form(name, text):
    return Entry.model_validate(entry(text, name).model_dump()).printed


def test_a_form_that_cannot_be_read_is_unreadable_or_mended(check, right):
    assert check.check(entry("(" + right)).verdict == "unreadable"
    emended = check.check(entry("(" + right, emendation={"why": "a bracket", **elements(right)}))
    assert emended.verdict == "correct after emendation"


def test_a_form_that_is_still_wrong_after_emendation_is_wrong(check, right):
    wrong = right.replace("l1 + ", "")
    checked = check.check(
        entry("(" + wrong, emendation={"why": "a bracket", **elements(wrong)}, corrected=elements(right))
    )
    assert checked.verdict == "wrong as printed"
    assert checked.measured.largest == pytest.approx(26.7)


@pytest.mark.parametrize(
    ("printed", "changes", "message"),
    [
        ("l1", {}, "has no correction"),
        ("l1", {"corrected": elements("l2")}, "the correction is wrong"),
        ("RIGHT", {"corrected": elements("l2")}, "is corrected, but its verdict is 'correct'"),
        ("RIGHT", {"emendation": {"why": "none", **elements("l2")}}, "is emended, but holds as printed"),
        ("l9", {}, "no name 'l9'"),
        ("l1/0", {}, "division by zero"),
    ],
)
def test_an_entry_that_contradicts_itself_is_our_fault(check, right, printed, changes, message):
    with pytest.raises(AuditError, match=message):
        check.check(entry(right if printed == "RIGHT" else printed, **changes))


def test_an_element_without_a_true_value_is_our_fault(check):
    with pytest.raises(AuditError, match="no true value of P_other"):
        check.check(entry("l1", name="P_other"))


def test_angles_are_compared_the_short_way_round():
    part = next(part for part in parts("xarm7") if part.symbols == "xarm7_inverse.symbols")
    check = Check(part, 50)
    turned = entry("atan2(P_ey, P_ex) + 2*3.141592653589793", "q1", derivation="xarm7_inverse.joints", unit="rad")
    assert check.check(turned).verdict == "correct"


def test_a_value_that_is_no_number_is_an_error_without_bound():
    part = next(part for part in parts("xarm7") if part.path.name == "5_seven_joints.yaml")
    with np.errstate(all="ignore"):
        checked = Check(part, 200).check(part.entries[0])
    assert checked.verdict == "wrong as printed"
    assert checked.measured.largest > 1


def spoilt(form, name):
    """Return a form with one side of one equation changed."""
    first, *others = form.elements[name].split("=")
    elements = form.elements | {name: "=".join([f"2*({first}) + 1/8", *others])}
    return type(form)(elements=elements, **{"why": form.why} if isinstance(form, Emendation) else {})


@pytest.mark.costs(6)
@pytest.mark.parametrize("source", sources())
def test_a_verdict_follows_from_the_text_that_is_shown(source):
    """The equations of right forms count, six of a form at least, and so do printed ones that are wrong."""
    for part in parts(source):
        check = Check(part, 4)
        for entry in (entry.as_read(source_of(source)) for entry in part.entries):
            key = "corrected" if entry.corrected else "emendation" if entry.emendation else "printed"
            names = list(entry.true_form.elements) if entry.derivation and entry.true_form.readable else []
            for name in names[:: max(1, len(names) // 6)]:
                with pytest.raises(AuditError, match=r"wrong|disagree"):
                    check.check(entry.model_copy(update={key: spoilt(entry.true_form, name)}))
            if entry.corrected and entry.printed.readable and not entry.emendation and entry.printed.elements:
                sound, name = check.check(entry), next(iter(entry.printed.elements))
                found = check.check(entry.model_copy(update={"printed": spoilt(entry.printed, name)}))
                assert found.measured.largest != sound.measured.largest or np.isinf(sound.measured.largest), entry.id


def test_only_these_are_checked_from_code():
    forms = [(e.id, f) for s in sources() for _, e in entries(s) for f in (e.printed, e.emendation, e.corrected) if f]
    assert {name for name, form in forms if form.code} == {"meca500-admittance"}


def test_a_left_side_can_be_an_expression_of_what_is_true():
    part = next(part for part in parts("thesis") if part.path.name == "3_2.yaml")
    check, right = Check(part, 10), next(entry for entry in part.entries if entry.id == "thesis-3.10")
    assert list(right.printed.elements) == ["tau - G"]
    assert check.check(right).verdict == "correct"
    lost = right.model_copy(update={"printed": Printed(elements={"ddq - q": "M @ ddq"})})
    with pytest.raises(AuditError, match=r"3_2.yaml, line 50: thesis-3.10: no true value of ddq - q; there is M, M_11"):
        check.check(lost)


def test_what_an_equation_defines_counts_before_a_symbol():
    part = parts("xarm7")[0]
    entry = next(entry for entry in part.entries if entry.id == "xarm7-transform-1")
    longer = entry.model_copy(update={"printed": Printed(elements=entry.printed.elements | {"l1": "27"})})
    with pytest.raises(AuditError, match=r"is wrong by 0\.3 cm"):
        Check(part, 10).check(longer)


def test_a_finding_is_filled_with_what_is_measured(check, right):
    finding = "Off by {largest}, typically {typical}, of {size}."
    checked = check.check(entry(f"{right} + 1/8", corrected=elements(right), finding=finding))
    assert checked.entry.finding == f"Off by 0.125 cm, typically 0.125 cm, of {checked.measured.size:.3g} cm."
    for printed, name in ((f"{right} + 1/8", "larges"), ("(" + right, "largest")):
        changes = {"corrected": elements(right)} if name == "larges" else {"emendation": {"why": "", **elements(right)}}
        with pytest.raises(AuditError, match=f"finding: no value '{name}'.*allowed, .*: largest, typical, size"):
            check.check(entry(printed, finding=f"{{{name}}}", **changes))
