"""`runner status` of sweeps: done, left, at work, failed."""

import os
import re
import shutil
import socket
import time
from dataclasses import replace

import pytest
from support.printed import without_caveats

from runner.base.machine import this_machine
from runner.store import open_runs
from runner.store.seal import sealed_json
from runner.sweeps.at_work import at_work


@pytest.fixture
def sweep(copy_sweep):
    return copy_sweep("goal", "other seed", "noise")


def test_an_ended_sweep_is_done(cli, sweep):
    ending = cli("status", sweep)
    assert (ending.code, without_caveats(ending.out)) == (0, "3 runs: 3 done, 0 left\n")


def test_what_is_left_is_counted_with_the_way_to_go_on(cli, sweep):
    runs = open_runs(sweep)
    shutil.rmtree(runs[0].folder)
    (runs[1].folder / "metrics.json").unlink()
    ending = cli("status", sweep)
    assert without_caveats(ending.out) == ("3 runs: 1 done, 2 left\nnot at work; continue with: runner -m ...\n")


def test_a_sweep_at_work_says_how_long_it_will_take(cli, sweep):
    shutil.rmtree(open_runs(sweep)[0].folder)
    here = rf"{re.escape(socket.gethostname())}, process {os.getpid()}, last sign \d s ago"
    with at_work(sweep):
        assert re.fullmatch(rf"at work \({here}\)", cli("status", sweep).out.splitlines()[-1])
        (sweep / "progress.json").write_bytes(sealed_json({"seconds_per_run": 100.0}))
        assert re.fullmatch(rf"at work \({here}\), about 2 min to go", cli("status", sweep).out.splitlines()[-1])
        with at_work(sweep):
            line = cli("status", sweep).out.splitlines()[-1]
            assert re.fullmatch(rf"at work \({here}; {here}\), about 50 s to go", line)
    assert cli("status", sweep).out.splitlines()[-1].startswith("not at work")


def test_a_command_of_another_machine_is_at_work_until_it_gives_no_sign(cli, sweep):
    shutil.rmtree(open_runs(sweep)[0].folder)
    sign = sweep / "at_work-1234"
    sign.write_text("n1\njob 16_3\n")
    for age, expected in ((30, "at work (n1, job 16_3, last sign 30 s ago)"), (130, "not at work; continue with: ")):
        os.utime(sign, (time.time() - age, time.time() - age))
        assert cli("status", sweep).out.splitlines()[-1].startswith(expected)
    assert "nothing is removed" not in cli("results", "--delete", "0d", "--yes").err


def test_failed_runs_are_counted_in_shards_too(cli):
    cell = ("plant=rk4", "controller.period=0.01,0.06", "controller.singularity_damping=0", "trajectory=quintic")
    sweep = cli("-m", "hydra.sweeper.workers=0", "robot=macro", *cell, "sweep.trace=never").folder
    counted, caveats = cli("status", sweep).out.splitlines()
    assert counted == "2 runs: 2 done (1 of them failed), 0 left"
    assert caveats.startswith("1 of 2 stored cells have caveats")  # the one that fails has gains beyond its period


def test_a_folder_that_is_no_sweep(cli, tmp_path):
    ending = cli("status", tmp_path)
    assert ending.code == 2
    assert "it is not the folder of a stored result. Allowed: the folder of a sweep" in ending.err


@pytest.mark.parametrize("trace", ["all", "never"])
def test_a_sweep_that_went_on_on_another_machine_names_both(cli, monkeypatch, trace):
    words = ("-m", "hydra.sweeper.workers=0", "robot=macro", "duration=0.05", f"sweep.trace={trace}")
    here, other = this_machine(), replace(this_machine(), openblas="Prescott", numpy="")
    with monkeypatch.context() as elsewhere:
        for module in ("runner.simulation.provenance", "runner.sweeps.batch"):
            elsewhere.setattr(f"{module}.this_machine", lambda: other)
        assert "machines" not in cli(*words, "seed=0,1").err
    ended = cli(*words, "seed=0,1,2")
    cores = f"2 runs on OpenBLAS Prescott; 1 run on OpenBLAS {here.openblas}"
    expected = f"made on 2 machines, which may round differently: {cores}"
    assert f"runner: {expected}\n" in ended.err
    assert expected in cli("status", ended.folder).out.splitlines()
    page = (cli("report", ended.folder, "--format", "html").folder / "report.html").read_text()
    assert f"<dd>{here.text}; {other.text}</dd>" in page or f"<dd>{other.text}; {here.text}</dd>" in page
