"""The findings of the xArm7 report: each of their conditions can fail, and with the whole runs all of them hold."""

from pathlib import Path

import pytest
from support.thin_plans import make_runs, stand_ins
from support.work_plans import chapter_files, conditions_that_never_fail, xarm7_moments, xarm7_studies

from runner.reporting.findings import findings
from runner.store import Run
from runner.works.work import load_work


@pytest.fixture(scope="module")
def runs(shared_store: Path) -> dict[str, Run]:
    """Every run of the plan: the studies' cut to a moment, of each kind of them two."""
    studied, jobs = xarm7_studies(), load_work("xarm7").jobs()
    experiments = {name: job.overrides for name, job in jobs.items() if name not in studied}
    studies = make_runs(shared_store, xarm7_moments(), stand_ins(xarm7_moments(), thin=True, every=("payload/",)))
    return make_runs(shared_store, experiments) | studies


@pytest.mark.parametrize("file", chapter_files("xarm7"))
def test_every_condition_fails_for_some_value(runs: dict[str, Run], file: str) -> None:
    assert conditions_that_never_fail("xarm7", file, runs) == []


@pytest.mark.slow
def test_every_finding_holds_with_the_whole_runs(shared_store: Path) -> None:
    whole = make_runs(shared_store, {name: job.overrides for name, job in load_work("xarm7").jobs().items()})
    held = [found for _, found in findings(load_work("xarm7").document(whole, {}))]
    assert len(held) == 19
    assert [found.text for found in held if not found.holds] == []
