"""Addresses and scheduler files of `hydra.sweeper.address` at which no scheduler is found."""

import pytest

from runner.base.errors import ConfigError, RunnerError, TemporaryError
from runner.sweeps.run import Engine


@pytest.fixture(autouse=True)
def _short_waits(monkeypatch):
    for name in ("_ANSWER_WITHIN", "_BEGIN_WITHIN", "_LOOK_EVERY"):
        monkeypatch.setattr(f"runner.sweeps.remote.{name}", 0.2)


@pytest.mark.parametrize(
    "text", ["tcp://10.0.0.1:8786", "10.0.0.1:8786", "tls://[::1]:80", "scheduler.json", "~/s.json"]
)
def test_an_address_or_a_scheduler_file(text):
    assert Engine(0, text).address == text


@pytest.mark.parametrize("text", ["", "scheduler", "tcp://10.0.0.1", "10.0.0.1", "tcp://a b:80", 8786, True])
def test_what_is_neither_is_refused(text):
    with pytest.raises(
        ConfigError, match=r"hydra\.sweeper\.address: must be the address of a Dask scheduler, .* found"
    ):
        Engine(0, text)


def test_a_scheduler_that_does_not_answer_is_named(sweep):
    with pytest.raises(
        RunnerError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9; start one with `dask"
    ) as no:
        sweep("seed=0,1", engine=Engine(2, "tcp://127.0.0.1:9"))
    assert no.value.exit_code == 2


def test_a_scheduler_file_of_a_scheduler_that_has_ended(sweep, tmp_path):
    (tmp_path / "old.json").write_text('{"address": "tcp://127.0.0.1:9"}')
    with pytest.raises(
        RunnerError,
        match=r"answers at tcp://127\.0\.0\.1:9, which .*old\.json names; remove the file, and start one with `dask .*"
        r"--scheduler-file .*old\.json` and workers with `dask worker --scheduler-file",
    ):
        sweep("seed=0,1", engine=Engine(0, f"{tmp_path}/old.json"))


def test_a_scheduler_file_that_does_not_appear(sweep, tmp_path):
    with pytest.raises(
        TemporaryError, match=r"no scheduler has written .*none\.json within 0\.2 s; start one with"
    ) as no:
        sweep("seed=0,1", engine=Engine(0, f"{tmp_path}/none.json"))
    assert no.value.exit_code == 75


@pytest.mark.parametrize("content", ["", "{", "[]", '{"address": 3}', '{"address": "here"}', "[" * 200, "\x00"])
def test_a_file_that_is_no_scheduler_file(sweep, tmp_path, content):
    (tmp_path / "other.json").write_text(content)
    with pytest.raises(
        RunnerError, match=r"other\.json is not a scheduler file of Dask; start one with `dask scheduler"
    ):
        sweep("seed=0,1", engine=Engine(0, f"{tmp_path}/other.json"))


def test_the_exit_code_of_a_command_says_that_it_continues(cli, tmp_path):
    ending = cli("-m", "robot=macro", "duration=0.05", "seed=0,1", "hydra.sweeper.address=none.json")
    assert (ending.code, ending.out) == (75, "")
    (tmp_path / "none.json").write_text("{}")
    assert cli("-m", "robot=macro", "duration=0.05", "seed=0,1", "hydra.sweeper.address=none.json").code == 2
