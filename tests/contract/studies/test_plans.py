"""Plans of studies: the configs know every robot and key that is in one, though few of its runs are simulated."""

from collections.abc import Iterator

import pytest
from support.study_plans import RECORDED, planned
from support.thin_plans import Overrides

from runner.assembly.validation import validate
from runner.base.engines import has_pybullet
from runner.config.compose.compose import compose
from runner.papers.study.study import load_study


def parts(overrides: Overrides) -> set[str]:
    """Return the robot and the keys of a run."""
    return {text if text.startswith("robot=") else text.partition("=")[0] for text in overrides}


def covering(jobs: dict[str, Overrides]) -> Iterator[Overrides]:
    """Yield runs so that each key, and each robot, is in one of them; options are tested with the configs."""
    left = set().union(*map(parts, jobs.values()))
    while left:
        overrides = max(jobs.values(), key=lambda run: len(parts(run) & left))
        left -= parts(overrides)
        yield overrides


@pytest.mark.costs(3)
@pytest.mark.parametrize("study", RECORDED)
def test_each_robot_and_key_of_a_plan_is_taken(study: str) -> None:
    dirs = load_study(study).config_dirs
    jobs = planned(study)
    if not has_pybullet():
        jobs = {name: overrides for name, overrides in jobs.items() if not any("bullet" in text for text in overrides)}
    for overrides in covering(jobs):
        composed = compose(overrides, dirs)
        assert validate(composed).timing.ticks > 0
