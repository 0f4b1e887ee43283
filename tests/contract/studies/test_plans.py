"""Plans of studies: the configs know every robot and key that stands in one, though few of its runs are made."""

from collections.abc import Iterator

import pytest
from support.thin_plans import Overrides
from support.work_plans import RECORDED, planned

from runner.config.compose import compose
from runner.config.validation import validate
from runner.works.work import load_work


def covering(jobs: dict[str, Overrides]) -> Iterator[Overrides]:
    """Yield runs so that each key, and each robot, stands in one of them; options are tested with the configs."""
    seen: set[str] = set()
    for overrides in sorted(jobs.values(), key=len, reverse=True):
        parts = {text if text.startswith("robot=") else text.partition("=")[0] for text in overrides}
        if not parts <= seen:
            seen |= parts
            yield overrides


@pytest.mark.costs(3)
@pytest.mark.parametrize("study", RECORDED)
def test_each_robot_and_key_of_a_plan_is_taken(study: str) -> None:
    dirs = load_work(study).config_dirs
    for overrides in covering(planned(study)):
        composed = compose(overrides, dirs)
        assert validate(composed.resolved, composed.config_dirs).timing.ticks > 0
