"""Claims that were changed after their runs were judged, by the file that remembers what they were."""

from types import SimpleNamespace

import pytest
import yaml

from runner.base.errors import StoreError
from runner.papers.study.claims import late_claims

CLAIM = {
    "number": 1, "statement": "The tip settles", "place": "section 2", "printed": [0.9], "unit": "s", "run": "goal",
    "metric": "settling_time", "reason": "",
}  # fmt: skip
RUNS = {f"goal/{preset}": SimpleNamespace(hash=preset * 3) for preset in "ab"}


@pytest.fixture
def judge(tmp_path):
    """Write a claim with some changes, and return the late claims of a judgement on a date."""

    def judged(date, runs=RUNS, **changes):
        (tmp_path / "claims.yaml").write_text(yaml.safe_dump([CLAIM | changes]))
        study = SimpleNamespace(name="mine", folder=tmp_path, manifest=SimpleNamespace(presets=dict.fromkeys("ab", "")))
        return late_claims(tmp_path / "outputs", study, runs, date)

    return judged


def test_a_claim_that_is_changed_after_it_was_judged_is_told_with_what_stood_before(judge):
    assert judge("2026-01-02") == judge("2026-01-03") == []
    late = judge("2026-02-03", printed=[1.9])
    assert late == ["claim 1 was set after the result was known (2026-02-03; before: printed: [0.9])"]
    assert judge("2026-03-04", printed=[1.9], statement="It settles", reason="slower") == late
    assert judge("2026-04-05") == []


def test_other_runs_are_another_result_and_those_that_are_missing_none(judge):
    judge("2026-01-02")
    other = {**RUNS, "goal/b": SimpleNamespace(hash="ccc")}
    assert judge("2026-02-03", runs=other, printed=[1.9]) == []
    assert judge("2026-02-03", runs={"goal/a": RUNS["goal/a"]}, printed=[2.9]) == []
    assert judge("2026-03-04", printed=[2.9])


def test_a_study_without_claims_leaves_no_file(tmp_path):
    study = SimpleNamespace(name="mine", folder=tmp_path)
    assert late_claims(tmp_path / "outputs", study, {}) == []
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_was_changed_is_told(judge, tmp_path):
    judge("2026-01-02")
    path = tmp_path / "outputs" / "claims" / "mine.json"
    path.write_text(path.read_text().replace("0.9", "1.9"))
    with pytest.raises(StoreError, match=r"mine\.json: it is damaged: .*; remove it to forget what claims were judged"):
        judge("2026-02-03", printed=[1.9])
