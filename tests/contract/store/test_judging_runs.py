"""A stored run, its spec, and what another spec makes of the stored values."""

import json

import numpy as np
import pytest

from runner.config.spec import Bound
from runner.execution import run
from runner.store import open_run, open_sweep, write_sweep

SHORT = ("robot=macro", "plant=rk4", "noise=thesis", "duration=0.3", "repetitions=12")
METRIC = "cross_track_error"


@pytest.fixture(scope="module")
def median(tmp_path_factory):
    return float(np.median(run(*SHORT, f"outputs={tmp_path_factory.mktemp('first')}").values(METRIC)))


def test_a_run_stores_how_often_it_keeps_its_spec(tmp_path, median):
    made = run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.max={median!r}")
    stored = json.loads((made.folder / "metrics.json").read_text())["spec"]
    assert stored["bounds"][METRIC]["max"] == median
    assert (stored["all"]["kept"], stored["all"]["of"]) == (6, 12)
    assert open_run(made.folder).spec == made.spec
    assert "spec" not in run(*SHORT, "seed=1", f"outputs={tmp_path}").record


def test_another_spec_is_worked_out_from_the_stored_values(tmp_path, median, capsys):
    made = run(*SHORT, f"outputs={tmp_path}")
    trace = (made.folder / "trace.parquet").stat().st_mtime_ns
    found = run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.max={median!r}")
    assert "stored before without a spec; the shares are worked out from its stored values" in capsys.readouterr().err
    assert (made.spec, found.spec.whole.kept) == (None, 6)
    assert found.folder == made.folder
    again = open_run(made.folder)  # its digests are right, and all else is as it was
    assert again.spec == found.spec
    assert {**again.record, "spec": None} == {**made.record, "spec": None}
    assert again.trace.equals(made.trace)
    assert (made.folder / "trace.parquet").stat().st_mtime_ns == trace
    run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.min=0")
    assert "stored before with another spec" in capsys.readouterr().err
    kept = run(*SHORT, f"outputs={tmp_path}")
    assert capsys.readouterr().err == ""
    assert kept.spec.config == {METRIC: Bound(min=0.0)}


def test_a_sweep_judges_its_runs_by_its_own_spec(tmp_path, median):
    made = run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.min=0")
    spec = {METRIC: Bound(max=median, reason="half")}
    folder = write_sweep(tmp_path, [(("seed=0",), made.hash)], "runner -m ...", spec)
    sweep = open_sweep(folder)
    (judged,) = sweep.runs()
    assert sweep.spec == judged.spec.config == spec
    assert (judged.spec.whole.kept, made.spec.whole.kept) == (6, 12)
    assert write_sweep(tmp_path, [(("seed=0",), made.hash)], "runner -m ...") == folder
    assert open_sweep(folder).spec == {}
