"""`runner compare` of stored sweeps: how cells are matched, counted and refused."""

import shutil

import pytest

TASK = ("robot=macro", "duration=0.05", "noise=thesis", "repetitions=6", "hydra.sweeper.workers=0")


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """Outputs for all tests that only read: cells of several sweeps are made once."""
    return f"outputs={tmp_path_factory.mktemp('compared')}"


@pytest.fixture(name="sweep")
def _sweep(cli, shared):
    return lambda *overrides: cli("-m", *TASK, shared, *overrides).folder


def cells(text, *names):
    """Return the cells behind the first ones of the line that starts with these."""
    lines = [line.split() for line in text.splitlines()]
    return next(line[len(names) :] for line in lines if line[: len(names)] == list(names))


def test_cells_are_matched_however_the_sweeps_are_ordered(cli, sweep):
    a = sweep("gravity=9.81,9.7", "controller.damping_ratio=1,0.9")
    b = sweep("controller.damping_ratio=0.9,1.0", "gravity=9.70,9.81,9.6", "torque_limits.max=100000")
    ending = cli("compare", a, b, "--all")
    assert (ending.code, ending.err) == (0, "")
    assert "\nA and B differ only in torque_limits.max: null against 100000.\n" in ending.out
    assert "4 cells are in both, matched by gravity, controller.damping_ratio; up to 6 repetitions" in ending.out
    assert "2 cells are only in B: gravity=9.6, controller.damping_ratio=0.9; gravity=9.6" in ending.out
    *_, word, below, above = cells(ending.out, "energy", "J")
    assert (word, below, above) == ("rounding", "0,", "0")  # no torque comes near the limit


def test_a_key_that_one_sweep_fixes_or_leaves_is_matched_by_its_resolved_value(cli, sweep):
    a = sweep("gravity=9.81,9.7", "controller.damping_ratio=1.0")
    b = sweep("gravity=9.81,9.7", "controller.damping_ratio=1.0,0.9")
    left = sweep("gravity=9.81,9.7", "torque_limits.max=30")
    for other in (a, left):
        out = cli("compare", other, b).out
        assert "2 cells are in both, matched by gravity, controller.damping_ratio" in out
        assert "2 cells are only in B: gravity=9.81, controller.damping_ratio=0.9" in out


def test_a_sweep_and_itself_differ_in_nothing(cli, sweep):
    a = sweep("gravity=9.81,9.7")
    out = cli("compare", a, a).out
    assert "\nA and B differ in no value.\n2 cells are in both" in out
    assert "largest differences in one cell" not in out


def test_what_else_differs_is_named_before_any_number(cli, sweep):
    a = sweep("trajectory=quintic", "controller=computed_torque", "gravity=9.81,9.7")
    b = sweep(
        "trajectory=quintic", "controller=operational_space", "gravity=9.81,9.7", "controller.natural_frequency=20"
    )
    out = cli("compare", a, b).out
    head, _ = out.split("metric ", 1)
    assert "differ in controller (computed_torque against operational_space), and also in " in head
    assert "controller.natural_frequency" in head
    assert cells(head, "controller.natural_frequency")[-1] == "20"


def test_several_sweeps_are_held_against_the_first(cli, sweep):
    folders = [sweep("gravity=9.81,9.7", f"torque_limits.max={limit}") for limit in (30, 31, 32)]
    out = cli("compare", *folders, "--metrics", "energy").out
    assert "A and B differ only in torque_limits.max: 30 against 31." in out
    assert "A and C differ only in torque_limits.max: 30 against 32." in out
    assert "peak_torque" not in out
    assert "B and C" not in out


def test_seeds_that_vary_noise_alone_are_said_once_for_a_comparison(cli, sweep):
    a, b = sweep("gravity=9.81,9.7"), sweep("gravity=9.7,9.81", "torque_limits.max=30")
    assert cli("compare", a, b).out.count("Repetitions draw only noise") == 1
    c, d = (sweep("gravity=9.81,9.7", "mismatch.spread=0.1", f"torque_limits.max={limit}") for limit in (30, 31))
    assert "draw only noise" not in cli("compare", c, d).out


def test_sweeps_that_share_no_cell_are_refused_with_where_they_part(cli, sweep):
    a, b = sweep("gravity=9.81,9.7"), sweep("gravity=9.6,9.5", "torque_limits.max=30,31")
    ending = cli("compare", a, b)
    assert (ending.code, ending.out) == (2, "")
    assert "share no cell: gravity is 9.81, 9.7 in A and 9.6, 9.5 in B; torque_limits.max is null in A" in ending.err
    assert ending.err.count("\n") == 1


def test_sweeps_of_other_seeds_are_refused(cli, sweep):
    ending = cli("compare", sweep("gravity=9.81,9.7"), sweep("gravity=9.81,9.7", "seed=1"))
    assert ending.code == 2
    assert "have 2 cells in common, but no seed" in ending.err


def test_cells_that_are_not_stored_are_counted_and_the_others_are_compared(cli):
    grid = ("-m", *TASK, "gravity=9.81,9.7,9.6")
    a, b = cli(*grid).folder, cli(*grid, "torque_limits.max=30").folder
    gone = cli(*TASK[:-1], "gravity=9.6", "torque_limits.max=30").folder
    shards = list((b.parent.parent / "runs").glob("*.shard*"))
    assert not shards  # else what is removed would still be stored
    shutil.rmtree(gone)
    ending = cli("compare", a, b)
    assert ending.code == 0
    assert "2 cells are in both" in ending.out
    assert "1 cell is only in A: gravity=9.6" in ending.out
    assert "1 cell of B is not stored, so that none has gravity=9.6; what follows holds for the others; " in ending.out
    assert "continue with: runner -m " in ending.out


def test_failed_cells_are_counted(cli, sweep):
    unstable = ("plant=rk4", "controller.singularity_damping=0", "trajectory=quintic", "duration=1")
    a = sweep(*unstable, "controller.period=0.06,0.01")
    ending = cli("compare", a, a)
    assert ending.code == 0
    assert "2 cells, 1 of them failed" in ending.out
    assert "1 cell of A failed; a failed repetition counts as beyond every number" in ending.out
    lost = sweep(*unstable, "controller.period=0.06,0.061")
    ending = cli("compare", a, lost)
    assert (ending.code, ending.out) == (2, "")
    assert ending.err == "runner: A and B have no metric in common: all runs of one of them failed\n"


def test_a_run_against_a_sweep_is_refused_with_what_works(cli, sweep, shared):
    a = sweep("gravity=9.81,9.7")
    cell, other = (cli(*TASK[:-1], shared, f"gravity={gravity}").folder for gravity in (9.81, 9.6))
    ending = cli("compare", cell, a)
    assert (ending.code, ending.out) == (2, "")
    assert "This run is the cell robot=macro " in ending.err
    assert f"`runner compare {a} --by AXIS`" in ending.err
    assert "A cell of the sweep is also a run; `runner robot=macro " in cli("compare", a, other).err


def test_an_unknown_metric_is_refused(cli, sweep):
    a = sweep("gravity=9.81,9.7")
    ending = cli("compare", a, a, "--metrics", "enrgy")
    assert (ending.code, ending.out) == (2, "")
    assert "metrics: unknown metric 'enrgy'. Allowed: " in ending.err
