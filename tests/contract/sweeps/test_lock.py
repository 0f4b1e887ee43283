"""The lock of an outputs folder, held by a process that is killed."""

import subprocess
import sys

import pytest
from support.patience import PATIENCE

from runner.base.errors import RunnerError
from runner.sweeps.status import at_work, is_at_work

HOLDS = (
    "import sys; from pathlib import Path; from runner.sweeps.status import at_work; \n"
    "with at_work(Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
)


def test_a_killed_process_leaves_no_lock(tmp_path, monkeypatch):
    monkeypatch.setattr("runner.sweeps.status._PATIENCE", 0.1)
    holder = subprocess.Popen([sys.executable, "-c", HOLDS, tmp_path], stdin=-1, stdout=-1)
    assert holder.stdout.readline() == b"held\n"
    assert is_at_work(tmp_path)
    with pytest.raises(RunnerError, match="another sweep is at work in"), at_work(tmp_path):
        pass
    holder.kill()
    holder.communicate(timeout=PATIENCE)
    assert not is_at_work(tmp_path)
    with at_work(tmp_path):
        assert is_at_work(tmp_path)
    assert [*tmp_path.iterdir()] == []
