"""A stored run, its spec, and what another spec makes of the stored values."""

import json
import re

import numpy as np
import pytest

from runner.reporting.document import Notice
from runner.reporting.outline import blocks
from runner.reporting.spec_blocks import spec_rows
from runner.reporting.sweep.report import sweep_document
from runner.schema.bound import Bound
from runner.store import judge_run, open_run, open_sweep, write_sweep
from runner.sweeps.job import run

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
    assert "stored before without a spec; the shares are computed from its stored values" in capsys.readouterr().err
    assert (made.spec, found.spec.whole.kept) == (None, 6)
    assert found.folder == made.folder
    again = open_run(made.folder)  # its digests are right, and all else is as it was
    assert again.spec == found.spec
    assert {**again.record, "spec": None} == {**made.record, "spec": None}
    assert again.trace().equals(made.trace())
    assert (made.folder / "trace.parquet").stat().st_mtime_ns == trace
    run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.min=0")
    assert "stored before with another spec" in capsys.readouterr().err
    kept = run(*SHORT, f"outputs={tmp_path}")
    assert capsys.readouterr().err == ""
    assert kept.spec.config == {METRIC: Bound(min=0.0)}


def test_a_bound_that_is_set_after_the_result_is_kept_with_its_date_and_what_stood_before(tmp_path, median):
    made = run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.min=0")
    (row,) = spec_rows(made.spec)
    assert "set after" not in row[0]
    low, high = Bound(max=median), Bound(max=2.0 * median)
    judge_run(judge_run(made, {METRIC: low}, "2026-02-03"), {METRIC: high, "peak_torque": Bound(min=0.0)}, "2026-03-04")
    kept = open_run(made.folder)
    dates = [date for date, _ in kept.record["spec"]["history"][METRIC]]
    assert dates == [made.provenance["date"], "2026-02-03", "2026-03-04"]
    first, second, _ = (text for text, *_ in spec_rows(kept.spec))
    assert re.search(r", set after the result was known \(2026-03-04; before: at least 0 m, then at most .*\)$", first)
    assert second.endswith("largest torque at least 0 N m, set after the result was known (2026-03-04; before: none)")
    # One that was before keeps its date; that with which the run was simulated was never set late.
    again = judge_run(kept, {METRIC: low}, "2026-05-06")
    assert "known (2026-02-03; before: at least 0 m)" in spec_rows(again.spec)[0][0]
    assert spec_rows(judge_run(again, {METRIC: Bound(min=0.0, reason="none is less")}, "2026-07-08").spec) == [row]


def test_a_sweep_remembers_its_bounds_and_tells_which_cells_were_made_before(tmp_path, median):
    spec, jobs = {METRIC: Bound(max=median)}, []
    for seed, bound in ((0, "max=1"), (1, f"max={median!r}")):
        made = run(*SHORT, f"seed={seed}", f"outputs={tmp_path}", f"spec.metrics.{METRIC}.{bound}")
        jobs.append(((f"seed={seed}",), made.hash))
    write_sweep(tmp_path, jobs, "runner -m ...", {}, "2026-01-02")
    write_sweep(tmp_path, jobs, "runner -m ...", spec, "2026-02-03")
    folder = write_sweep(tmp_path, jobs, "runner -m ...", spec, "2026-03-04")
    late, in_time = (spec_rows(run.spec)[0][0] for run in open_sweep(folder).runs())
    assert late.endswith(", set after the result was known (2026-02-03; before: at most 1 m)")
    assert "set after" not in in_time
    document = sweep_document(open_sweep(folder))
    told = "set after the result was known (2026-02-03; before: at most 1 m): 1 of 2 cells."
    assert told in document.abstract
    (notice,) = [block for block in blocks(document) if isinstance(block, Notice)]
    assert notice.text.endswith(told)


def test_a_sweep_judges_its_runs_by_its_own_spec(tmp_path, median):
    made = run(*SHORT, f"outputs={tmp_path}", f"spec.metrics.{METRIC}.min=0")
    spec = {METRIC: Bound(max=median, reason="half")}
    folder = write_sweep(tmp_path, [(("seed=0",), made.hash)], "runner -m ...", spec)
    sweep = open_sweep(folder)
    (own,) = sweep.runs()
    assert sweep.spec == own.spec.config == spec
    assert (own.spec.whole.kept, made.spec.whole.kept) == (6, 12)
    assert write_sweep(tmp_path, [(("seed=0",), made.hash)], "runner -m ...") == folder
    assert open_sweep(folder).spec == {}
