"""A share of the made-up logs: one of each fault."""

import pytest

from tools.made_up_logs import FAULTS, judge_log


@pytest.mark.costs(4)
def test_a_fault_of_each_kind_is_asked_for_and_a_right_log_is_not():
    answers = dict(judge_log(5 * place) for place in range(len(FAULTS)))
    assert answers == dict.fromkeys(FAULTS, "asked") | {"none": "right"}
