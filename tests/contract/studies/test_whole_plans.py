"""Whole plans of studies, with real runs: findings hold, conditions can fail, and recorded runs are not stale."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from fixtures.studies import Made
from support.recorded_runs import recorded
from support.study_plans import RECORDED, meca500_calibrations, meca500_jobs, planned, recorded_jobs, thesis_jobs
from support.thin_plans import make_calibrations, make_runs

from runner.papers.study.check import never_failing
from runner.papers.study.expected_caveats import unexpected_caveats
from runner.papers.study.measured import findings
from runner.papers.study.study import load_study
from runner.reporting.mathml import faulty
from runner.store import Run

# True of real numbers, which take minutes; from runs cut to a moment findings do not hold.
pytestmark = [pytest.mark.slow, pytest.mark.bullet]

OF_MANY_SEEDS = (  # these runs have two repetitions or one
    *("Under noise one-way control breaks", "Most verdicts are those", "The verdict on claim 9", "Medians keep"),
    *("Where the plants differ the plant decides", "The printed time of the pair follows", "Sent to the goal itself"),
    *("One-way control works up to", "Single seeds disagree", "Regular misses are a longer period"),
)
FINDINGS = {"xarm7": 23, "engines": 11, "precision": 4}
CLOSE = {"rel": 1e-3, "abs": 1e-9}  # what is recorded has six digits; rounding differs between machines


def whole(study: str, folder: Path, jobs: Mapping[str, tuple[str, ...]]) -> Made:
    """Make all runs of a plan, and measure what no run does."""
    loaded = load_study(study)
    calibrations = make_calibrations(folder, meca500_calibrations()) if study == "meca500" else {}
    made = Made(study, make_runs(folder, jobs, None, loaded.config_dirs), calibrations)
    loaded.measure(folder / "outputs")
    return made


def never_failing_in(made: Made) -> list[str]:
    files = [file for file in made.study.manifest.files() if file.endswith(".md")]
    return [told for file in files for told in never_failing(file, made.chapters.reading(file.removesuffix(".md")))]


@pytest.mark.parametrize("study", FINDINGS)
def test_every_finding_holds(shared_store: Path, study: str) -> None:
    made = whole(study, shared_store, planned(study))
    held = [found for _, found in findings(made.document)]
    assert [found.text for found in held if not found.holds] == []
    assert len(held) == FINDINGS[study]
    assert unexpected_caveats(made.runs, made.study.expected) == []
    assert never_failing_in(made) == []
    assert faulty(made.document) == []


@pytest.mark.parametrize("study", ["thesis", "thesis_beyond"])
def test_every_finding_of_the_thesis_holds(shared_store: Path, study: str) -> None:
    made = whole(study, shared_store, thesis_jobs(study))
    fallen = [found.claim for _, found in findings(made.document) if not found.holds]
    assert [claim for claim in fallen if not claim.startswith(OF_MANY_SEEDS)] == []
    assert never_failing_in(made) == []
    assert faulty(made.document) == []


def test_nothing_of_the_meca500_report_fails(shared_store: Path) -> None:
    made = whole("meca500", shared_store, meca500_jobs())
    assert [name for name, run in made.runs.items() if run.status != "ok"] == []
    assert never_failing_in(made) == []
    assert faulty(made.document) == []


@pytest.mark.parametrize("study", RECORDED)
def test_recorded_runs_are_those_that_the_runner_makes(shared_store: Path, study: str) -> None:
    """If they differ, `PYTHONPATH=tests .venv/bin/python -m support.recorded_runs STUDY` records them again."""
    kept, jobs = recorded(study, shared_store), recorded_jobs(study)
    assert set(kept) == set(jobs)
    made = make_runs(shared_store, jobs, None, load_study(study).config_dirs)
    assert [name for name in jobs if not same(made[name], kept[name])] == []


def same(made: Run, kept: Run) -> bool:
    """Return True if a run has the config, columns and metrics of a recorded one."""
    alike = {**made.config, "outputs": kept.config["outputs"]} == kept.config and made.units == kept.units
    ours, theirs = (
        {name: float("nan") if each.median is None else each.median for name, each in run.metrics.items()}
        for run in (made, kept)
    )
    return alike and made.status == kept.status and ours == pytest.approx(theirs, nan_ok=True, **CLOSE)
