"""Changes between two versions of a study."""

import copy
import json

import pytest

from runner.base.errors import RunnerError
from runner.papers.study.changes import FILE, VersionChange, changes, read_conclusions

OLD = {
    "thesis": {
        "title": "The thesis",
        "verdicts": [
            {"claim": "1", "ours": [{"preset": "full_equations", "measured": "1.3 s", "verdict": "matches"}]},
            {"claim": "2", "ours": [{"preset": "", "measured": "2 mm", "verdict": "larger than printed"}]},
        ],
        "findings": [{"title": "It follows", "text": "By 2 mm.", "holds": True}],
        "equations": [{"number": "3.4", "place": "page 3", "title": "Axis", "verdict": "correct"}],
        "caveats": [{"run": "goal", "rule": "saturation", "text": "joint q1 in 20 %"}],
        "numbers": {
            "goal": {
                "status": "ok",
                "metrics": {
                    "settling_time": {"unit": "s", "median": 1.3, "min": 1.2, "max": None},
                    "overshoot": {"unit": "m", "median": 0.0, "min": 0.0, "max": 0.0},
                },
            }
        },
        "calibrations": {
            "tool": {table: {"x": {"unit": "m", "median": 1.0, "min": 1.0, "max": 1.0}} for table in
                     ("estimates", "errors", "deviations")}
        },
    }
}  # fmt: skip


@pytest.fixture
def new():
    return copy.deepcopy(OLD)


def test_nothing_changed(new):
    assert changes(OLD, new) == []


def test_each_kind_is_told_with_what_it_was_and_is(new):
    thesis = new["thesis"]
    thesis["verdicts"][0]["ours"][0] = {
        "preset": "full_equations",
        "measured": "2.6 s",
        "verdict": "larger than printed",
    }
    thesis["findings"][0]["holds"] = False
    thesis["equations"][0]["verdict"] = "wrong as printed"
    thesis["caveats"] = [{"run": "goal", "rule": "chatter", "text": "joint q1 jumps"}]
    told = [(change.kind, change.name, change.old, change.new) for change in changes(OLD, new)]
    assert told == [
        ("verdict", "thesis: claim 1, full_equations", "matches", "larger than printed"),
        ("finding", "thesis: It follows", "holds", "no longer holds"),
        ("equation", "thesis: 3.4, page 3: Axis", "correct", "wrong as printed"),
        ("caveat", "thesis: goal: saturation", "joint q1 in 20 %", None),
        ("caveat", "thesis: goal: chatter", None, "joint q1 jumps"),
        ("measured", "thesis: claim 1, full_equations", "1.3 s", "2.6 s"),
    ]


def test_numbers_that_moved_most_come_first(new):
    metrics = new["thesis"]["numbers"]["goal"]["metrics"]
    metrics["settling_time"] |= {"median": 1.3 * (1 + 1e-9), "min": 2.4, "max": 3.0}
    metrics["overshoot"]["median"] = 1e-3
    new["thesis"]["calibrations"]["tool"]["errors"]["x"]["median"] = 1.5
    names = [change.name.removeprefix("thesis: ") for change in changes(OLD, new)]
    assert names == [
        "goal settling_time max (s)",
        "goal overshoot median (m)",
        "goal settling_time min (s)",
        "tool errors x median (m)",
        "goal settling_time median (s)",
    ]
    assert [change.kind for change in changes(OLD, new)] == ["number"] * 4 + ["rounding"]


@pytest.mark.parametrize(
    ("old", "new_value", "kind"),
    [
        (1.3, 1.3 * (1 + 0.9e-6), "rounding"),
        (1.3, 1.3 * (1 + 1.1e-6), "number"),
        (0.0, 0.9e-12, "rounding"),
        (0.0, 1.1e-12, "number"),
        (1.3, None, "number"),
        (None, 1.3, "number"),
    ],
)
def test_a_number_that_moves_by_rounding_is_of_its_own_kind(new, old, new_value, kind):
    before, after = copy.deepcopy(new), new
    for content, value in ((before, old), (after, new_value)):
        content["thesis"]["numbers"]["goal"]["metrics"]["settling_time"]["median"] = value
    assert [change.kind for change in changes(before, after)] == [kind]


def test_the_size_of_a_change_is_a_share():
    assert VersionChange("number", "a", 2.0, 3.0).size == pytest.approx(0.5)
    assert VersionChange("number", "a", 0.0, 3.0).size == VersionChange("number", "a", None, 3.0).size == float("inf")


def test_a_study_from_before_there_were_caveats_is_read(new):
    for key in ("caveats", "equations", "calibrations"):
        del new["thesis"][key]
    new["thesis"]["findings"][0]["holds"] = False
    told = [(change.kind, change.name, change.new) for change in changes(new, OLD)]
    assert told == [
        ("study", "thesis: equations", "there"),
        ("study", "thesis: caveats", "there"),
        ("study", "thesis: calibrations", "there"),
        ("finding", "thesis: It follows", "holds"),
    ]


def test_a_study_that_only_one_has_is_told():
    assert changes({}, OLD) == [VersionChange("study", "thesis", None, "The thesis")]


def test_conclusions_are_read_from_a_file_or_a_report_s_folder(tmp_path):
    (tmp_path / FILE).write_text(json.dumps(OLD))
    assert read_conclusions(tmp_path) == read_conclusions(tmp_path / FILE) == OLD


@pytest.mark.parametrize("text", [None, "{", "[]", '{"a": 1}', '{"a": {"b": 1}}', '{"a": {"title": "A"}, "b": 1}'])
def test_what_is_none_is_refused(tmp_path, text):
    file = tmp_path / "other.json"
    if text is not None:
        file.write_text(text)
    with pytest.raises(RunnerError, match=r"`runner reproduce NAME --json > FILE`"):
        read_conclusions(file)
