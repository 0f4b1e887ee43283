"""Schema of a run's record: a valid one, and each kind of fault by its key."""

import pytest

from runner.store.record import find_faults

METRIC = {"unit": "m", "values": [0.1, None], "median": 0.1, "min": 0.1, "max": None}
RECORD = {
    "status": "ok",
    "repetitions": 2,
    "metrics": {"settling_time": METRIC},
    "timing": {"wall_s": 1.0},
    "provenance": {
        "date": "2026-01-01", "command": "runner", "commit": None, "versions": {}, "machine": "x", "seed": 0,
        "plant_step": 0.001, "warnings": [],
    },
}  # fmt: skip
FAILURE = {"reason": "diverged", "time": 1.0, "joint": "q1", "repetition": 0}


def test_valid_records_have_no_fault():
    assert find_faults(RECORD) == ""
    assert find_faults({**RECORD, "status": "failed", "failure": FAILURE}) == ""


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"status": "failed"}, "failure: missing"),
        ({"status": "good"}, "status: "),
        ({"repetitions": "2"}, "repetitions: "),
        ({"metrics": {"a": {**METRIC, "median": float("inf")}}}, "metrics.a.median: "),
        ({"caveats": [{"rule": "saturation", "value": 1.0}]}, "caveats.0.text: "),
        ({"provenance": {}}, "provenance.date: "),
    ],
)
def test_faults_are_told_by_their_key(change, fault):
    assert find_faults({**RECORD, **change}).startswith(fault)
