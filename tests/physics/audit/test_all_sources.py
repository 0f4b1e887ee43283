"""Audit of all sources: verdicts of known slips, emendations and the table of equations."""

import csv
import io

import pytest

from runner.papers.audit.audit import as_csv, audit, audit_all, counts
from runner.papers.audit.sources import sources
from runner.papers.audit.verdict import SAMPLES, VERDICTS


@pytest.fixture(scope="session")
def everything():
    return audit_all(samples=100)


def verdicts(audited):
    return {each.entry.id: each.verdict for source in audited.values() for each in source}


def test_every_source_is_audited(everything):
    assert tuple(everything) == sources()


@pytest.mark.slow
def test_a_thousand_states_give_the_same_verdicts(everything):
    """A session takes a hundred: a wrong equation is wrong nearly everywhere."""
    assert SAMPLES == 1000
    assert verdicts(audit_all()) == verdicts(everything)


def test_what_is_wrong_is_wrong_in_both_ways_and_has_its_right_form(everything):
    for source in everything.values():
        for each in source:
            if each.verdict == "wrong as printed":
                assert each.entry.corrected is not None
                assert each.entry.finding
                assert min(each.measured.largest, each.second.largest) > each.entry.tolerance


@pytest.mark.parametrize(
    ("source", "numbers"),
    [
        ("xarm7", ("P_ex", "P_ey", "P_ez", "q2", "q4", "J_12", "J_47", "J_62", "J_67", "J^+", "text: direction")),
        ("meca500", ("Table 1, row 2", "Table 1, row 6", "G_y", "G_z", "M_gx", "J_g6,30", "J_g6,20", "M_p", "Theta")),
    ],
)
def test_the_known_slips_are_found(everything, source, numbers):
    verdicts = {each.entry.number: each.verdict for each in everything[source]}
    assert {number: verdicts[number] for number in numbers} == dict.fromkeys(numbers, "wrong as printed")


def test_the_column_of_the_first_joint_is_the_second_of_the_printed_jacobian(everything):
    right = {each.entry.number: each for each in everything["xarm7"]}
    for row in range(1, 7):
        printed = right[f"J_{row}2"].entry.printed.elements[f"J_{row}2"]
        assert right[f"J_{row}1"].entry.printed.elements[f"J_{row}1"] == printed


def test_the_table_has_a_line_for_each_equation(everything):
    checked = [each for source in everything.values() for each in source]
    rows = list(csv.DictReader(io.StringIO(as_csv(checked))))
    assert len(rows) == len(checked)
    assert sum(counts(checked).values()) == len(checked)
    by_id = {row["id"]: row for row in rows}
    assert by_id["xarm7-q2"]["verdict"] == "wrong as printed"
    assert float(by_id["xarm7-q2"]["largest_error"]) > 1
    assert by_id["xarm7-q2"]["corrected"].startswith("q2 = atan2(")
    assert {row["verdict"] for row in rows} == set(VERDICTS)


def test_fewer_samples_give_the_same_verdicts(everything):
    few = {each.entry.id: each.verdict for each in audit("meca500", samples=40)}
    assert few == {each.entry.id: each.verdict for each in everything["meca500"]}


def test_with_the_inverse_rotation_the_meca500_s_gravity_equations_are_right(everything):
    verdicts = {each.entry.id: each.verdict for each in everything["meca500"]}
    undefined = [f"meca500-{name}-{axis}" for name in ("rotated", "fit", "weight") for axis in "xyz"]
    assert {name: verdicts[name] for name in undefined} == dict.fromkeys(undefined, "correct")


def test_damaged_indices_are_mended_and_told(everything):
    emended = {each.entry.id for each in everything["meca500"] if each.verdict == "correct after emendation"}
    assert {"meca500-chain", "meca500-origin", "meca500-Jg054"} <= emended
