"""Runs repeated on a finer step: against the same runs on Runge-Kutta, and runs that cannot be repeated so."""

import numpy as np
import pytest
from support.engines import ASKED

from runner.base.errors import StoreError
from runner.reporting.comparison.pairs import compare, match
from runner.store.finished import finer_names, read_finer
from runner.sweeps.finer_step import DRAWS, work_out
from runner.sweeps.job import run
from runner.sweeps.measurements import measure_run

TASK = ("robot=macro", "trajectory=quintic", "trajectory.duration=0.5", "duration=0.6", "noise=thesis")


def made(tmp_path, *overrides, repetitions=10):
    found = run(*TASK, f"repetitions={repetitions}", f"outputs={tmp_path}", *overrides)
    work_out(tmp_path, [found])
    return found


@pytest.mark.parametrize(
    ("plant", "finer"),
    [((ASKED,), ("plant=rk4",)), (("plant=rk4", "plant.step=0.01"), ("plant=rk4", "plant.step=0.005"))],
)
def test_the_first_repetitions_are_those_of_the_same_run_on_the_finer_plant(tmp_path, plant, finer):
    own = made(tmp_path, *plant)
    expected = run(*TASK, "repetitions=10", f"outputs={tmp_path}", *finer)
    found = read_finer(tmp_path, own.hash)
    assert set(found) == set(own.metrics)
    for name, values in found.items():
        of_run = np.nan_to_num(expected.values(name)[:DRAWS], nan=np.inf)
        np.testing.assert_allclose(values, of_run, rtol=1e-9, atol=1e-12, err_msg=name)


def test_both_sides_err_alike_so_that_a_difference_errs_less(tmp_path):
    a, b = (made(tmp_path, ASKED, f"controller.natural_frequency={rate}") for rate in (20.0, 20.2))
    one, other = measure_run(a, "A"), measure_run(b, "B")
    error = compare(match(one, other), "rms_tracking_error").error
    each = np.median(np.abs(one.finer["rms_tracking_error"] - one.values["rms_tracking_error"][:, :DRAWS]))
    assert 0.0 < error < 0.1 * each
    assert compare(match(one, one), "rms_tracking_error").error == 0.0


def test_what_is_known_is_not_made_again(tmp_path, monkeypatch):
    own = made(tmp_path, ASKED)
    monkeypatch.setattr("runner.simulation.run.simulate_blocks", None)
    work_out(tmp_path, [own])


@pytest.mark.parametrize("repetitions", [1, 5])
def test_too_few_repetitions_for_a_comparison_are_not_made_again(tmp_path, repetitions):
    made(tmp_path, ASKED, repetitions=repetitions)
    assert finer_names(tmp_path) == set()


def test_a_wall_has_no_finer_step_and_the_error_is_not_known(tmp_path):
    found = run("robot=meca500", "controller=admittance", "environment=wall", "duration=0.05", "repetitions=6",
                f"outputs={tmp_path}")  # fmt: skip
    work_out(tmp_path, [found])
    assert finer_names(tmp_path) == {found.hash}
    assert read_finer(tmp_path, found.hash) == {}
    side = measure_run(found, "A")
    assert compare(match(side, side), "peak_force").error is None


def test_a_damaged_file_is_told(tmp_path):
    own = made(tmp_path, ASKED)
    (path,) = (tmp_path / "finer").iterdir()
    path.write_bytes(path.read_bytes().replace(b"0", b"1", 3))
    with pytest.raises(StoreError, match="delete it: `runner compare` computes it again"):
        measure_run(own, "A")
