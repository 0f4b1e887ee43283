"""Journals of tunings: read as written, reported if damaged, and continued wherever they were cut."""

import json
import math
import shutil

import pytest

from runner.base.errors import StoreError
from runner.store.seal import Lines
from runner.sweeps.tuning.journal import Journal, read_trials
from runner.sweeps.tuning.key import TunedKey
from runner.sweeps.tuning.objective import Objective, Trial

KEYS = [TunedKey("x", 0.0, 1.0, None, False, False)]
GOALS = [Objective("settling_time", "minimize"), Objective("peak_torque", "maximize")]
TRIALS = [
    Trial({"x": 0.25}, (1.5, 2.5), "abc", ""),
    Trial({"x": 0.1 + 0.2}, (math.inf, -math.inf), "", "controller.period: must be above 0; found 0"),
    Trial({"x": 0.5}, (1e-300, 3.0), "def", ""),
]


@pytest.fixture
def path(tmp_path):
    return tmp_path / "journal.log"


@pytest.fixture
def written(path):
    journal = Journal(path, KEYS, GOALS)
    for trial in TRIALS:
        journal.append(trial)
    return path


def test_trials_are_read_as_they_were_written(written):
    content = written.read_bytes()
    assert read_trials(written) == TRIALS
    assert Journal(written, KEYS, GOALS).trials == TRIALS
    assert written.read_bytes() == content
    assert all(isinstance(json.loads(line[33:]), dict) for line in content.splitlines())


def test_the_journal_of_another_tuning_is_told(tmp_path):
    one, other = (tmp_path / "tunings" / name / "journal.log" for name in ("one", "other"))
    for path in (one, other):
        path.parent.mkdir(parents=True)
        Journal(path, KEYS, GOALS)
    Journal(one, KEYS, GOALS).append(TRIALS[0])
    shutil.copy(one, other)
    for read in (read_trials, lambda path: Journal(path, KEYS, GOALS)):
        with pytest.raises(StoreError, match=r"other/journal\.log: it is damaged: .*; remove it to restart"):
            read(other)
    kept = shutil.copytree(one.parent, tmp_path / "kept")  # a copy elsewhere may have any name
    assert read_trials(kept / "journal.log") == TRIALS[:1]


@pytest.mark.parametrize(
    ("line", "change"),
    [
        (0, {"op_code": 99}),
        (1, {"values": None}),
        (1, {"params": [3]}),
        (2, {"user_attrs": {"failure": "none"}}),
        (3, {"distributions": "eval"}),
    ],
)
def test_a_journal_that_somebody_made_up_is_told_though_its_digests_are_right(written, line, change):
    logs = [json.loads(text) for text in Lines().read(written.read_bytes())]
    logs[line] |= change
    sealed = Lines()
    written.write_text("".join(f"{sealed.seal(json.dumps(log))}\n" for log in logs))
    for read in (read_trials, lambda path: Journal(path, KEYS, GOALS)):
        with pytest.raises(StoreError, match=r"journal\.log: it is damaged: "):
            read(written)


@pytest.mark.parametrize("change", ["swap", "drop", "edit", "unseal"])
def test_a_line_that_is_not_as_it_was_written_is_told(written, change):
    lines = written.read_bytes().splitlines()
    if change == "swap":
        lines[2], lines[3] = lines[3], lines[2]
    elif change == "drop":
        del lines[2]
    else:
        lines[2] = lines[2].replace(b"0.3", b"0.4") if change == "edit" else lines[2][33:]
        assert change == "unseal" or b"0.4" in lines[2]
    written.write_bytes(b"\n".join([*lines, b""]))
    message = r"journal\.log: it is damaged: line 3 has another digest than it says; remove"
    with pytest.raises(StoreError, match=message):
        read_trials(written)


def test_a_journal_that_was_cut_anywhere_goes_on(written):
    content = written.read_bytes()
    for end in range(0, len(content) + 1, 7):
        written.write_bytes(content[:end])
        journal = Journal(written, KEYS, GOALS)
        whole = max(0, content[:end].count(b"\n") - 1)
        assert journal.trials == TRIALS[:whole]
        journal.append(TRIALS[0])
        assert read_trials(written) == [*TRIALS[:whole], TRIALS[0]]


def test_a_half_line_of_a_journal_at_work_is_no_trial(written):
    with written.open("ab") as file:
        file.write(b'{"op_code":4,')
    assert read_trials(written) == TRIALS


@pytest.mark.parametrize("content", [b"nonsense\nmore\n", b"{}\n{}\n", b'{"op_code":0}\n[]\n'])
def test_a_damaged_journal_is_told(path, content):
    path.write_bytes(content)
    with pytest.raises(StoreError, match=r"cannot read .*journal\.log"):
        read_trials(path)
    with pytest.raises(StoreError, match=r"remove it to restart the tuning"):
        Journal(path, KEYS, GOALS)


def test_no_journal_is_told(path):
    with pytest.raises(StoreError, match="no such file"):
        read_trials(path)
    assert not path.exists()


def test_a_full_disk_is_told(written, monkeypatch):
    journal = Journal(written, KEYS, GOALS)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(StoreError, match=r"cannot write .*journal\.log: No space left on device"):
        journal.append(TRIALS[0])
