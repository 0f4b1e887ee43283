"""`runner verify`: what is as written, what is damaged, and how it is fixed."""

import shutil

from fixtures.stored import SHORT


def test_what_is_as_it_was_written_is_counted(cli, copy_run):
    copy_run("goal")
    sweep = ("-m", *SHORT, "seed=1,2", "hydra.sweeper.workers=0", "sweep.trace=never")
    assert cli(*sweep).code == 0
    ending = cli("verify")
    assert (ending.code, ending.err) == (0, "")
    assert ending.out.splitlines() == ["runs: 1 as written", "shards: 2 as written", "sweeps: 1 as written"]


def test_damage_is_named_with_what_makes_it_anew(cli, copy_run):
    run = copy_run("goal")
    trace = run / "trace.parquet"
    trace.write_bytes(trace.read_bytes()[:-1])
    half = shutil.copytree(run, run.with_name("half"))
    (half / "metrics.json").unlink()
    ending = cli("verify", "outputs")
    assert ending.code == 1
    counts, problem = ending.out.splitlines()
    assert counts == "runs: 1 unfinished, 1 damaged"
    assert problem.endswith(
        "trace.parquet: it is damaged: its content has another digest than stored; run it again to repair it"
    )
    assert cli(*SHORT).code == 0
    shutil.rmtree(half)
    assert cli("verify").out == "runs: 1 as written\n"


def test_an_empty_folder_and_none(cli, tmp_path):
    assert cli("verify", tmp_path).out == f"nothing is stored in {tmp_path}\n"
    ending = cli("verify", "nowhere")
    assert (ending.code, ending.err) == (
        2,
        "runner: nowhere: no such folder. Allowed: an outputs folder, as in `runner verify outputs`.\n",
    )
