"""The Meca500 report's chapters in Markdown: no condition of a finding is such that nothing can refute it."""

import pytest
from support.thin_plans import make_calibrations, make_runs, stand_ins
from support.work_plans import chapter_files, conditions_that_never_fail, meca500_calibrations, meca500_jobs


@pytest.fixture(scope="module")
def made(shared_store, thin):
    jobs = meca500_jobs()
    runs = make_runs(shared_store, jobs, stand_ins(jobs, thin, every=("step/", "plants/", "rest/0")))
    return runs, make_calibrations(shared_store, meca500_calibrations())


@pytest.mark.parametrize("file", chapter_files("meca500"))
def test_each_condition_of_a_chapter_can_fail(file, made):
    assert conditions_that_never_fail("meca500", file, *made) == []
