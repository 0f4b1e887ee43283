"""`runner study diff`: what moved between two versions."""

import copy
import json

import pytest

METRIC = {"unit": "m", "median": 1.0, "min": 1.0, "max": 1.0}
OLD = {
    "thesis": {
        "title": "The thesis",
        "findings": [{"title": "It follows", "text": "By 2 mm.", "holds": True}],
        "numbers": {"goal": {"status": "ok", "metrics": {f"metric_{n}": dict(METRIC) for n in range(30)}}},
    }
}


@pytest.fixture
def versions(tmp_path):
    """Two files: the later version has another finding, and a number that moved in each of 30 metrics."""
    new = copy.deepcopy(OLD)
    new["thesis"]["findings"][0] |= {"title": "It follows \x1b[31mwell"}
    for n, metric in enumerate(new["thesis"]["numbers"]["goal"]["metrics"].values()):
        metric["median"] = 1.0 + n / 100.0
    for name, content in (("old", OLD), ("new", new)):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    return tmp_path / "old.json", tmp_path / "new.json"


def test_what_moved_is_printed_and_counted(cli, versions):
    ending = cli("study", "diff", *versions)
    assert (ending.code, ending.err) == (0, "")
    lines = ending.out.splitlines()
    assert lines[:2] == [
        "finding: thesis: It follows: holds -> none",
        r"finding: thesis: It follows \x1b[31mwell: none -> holds",
    ]
    assert lines[4] == "number: thesis: goal metric_29 median (m): 1 -> 1.29 (29 %)"
    assert lines[-2:] == [
        "number: 9 more; --all prints them",
        "finding: 2 changed; words: 2 changed; number: 29 changed",
    ]
    assert len(cli("study", "diff", *versions, "--all").out.splitlines()) == 2 + 2 + 29 + 1


def test_equal_versions_differ_in_nothing(cli, versions):
    assert cli("study", "diff", versions[0], versions[0]).out == "nothing changed\n"


def test_what_is_equal_up_to_rounding_is_counted(cli, tmp_path):
    new = copy.deepcopy(OLD)
    for metric in new["thesis"]["numbers"]["goal"]["metrics"].values():
        metric["median"] += 1e-14
    for name, content in (("old", OLD), ("new", new)):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    both = tmp_path / "old.json", tmp_path / "new.json"
    assert cli("study", "diff", *both).out == "nothing changed; 30 numbers equal up to rounding\n"
    assert len(cli("study", "diff", *both, "--all").out.splitlines()) == 31
    new["thesis"]["numbers"]["goal"]["metrics"]["metric_0"]["median"] = 2.0
    both[1].write_text(json.dumps(new))
    assert cli("study", "diff", *both).out.splitlines() == [
        "number: thesis: goal metric_0 median (m): 1 -> 2 (100 %)",
        "number: 1 changed; 29 numbers equal up to rounding",
    ]


def test_programs_get_all_of_it(cli, versions):
    written = json.loads(cli("study", "diff", *versions, "--json").out)
    assert len(written) == 2 + 2 + 29
    assert written[0] == {"kind": "finding", "name": "thesis: It follows", "old": "holds", "new": None}


def test_bad_input_is_told(cli, versions):
    ending = cli("study", "diff", versions[0], "nowhere.json")
    assert ending.code == 2
    assert ending.err.startswith("runner: cannot read nowhere.json: ")
    assert cli("study", "change", *versions).code == 2
