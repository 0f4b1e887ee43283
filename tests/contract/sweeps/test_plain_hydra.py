"""A hundred lines by plain Hydra and by the runner: the cells differ only where a difference is meant."""

import pytest

from tools.plain_hydra.comparison import OUTCOMES, compare
from tools.plain_hydra.lines import drawn, written
from tools.plain_hydra.meant import MEANT, reason_for

SAME = OUTCOMES[:2]
LINES = [*written()[::2], *drawn(50, 68)]


@pytest.mark.costs(1)
@pytest.mark.parametrize("line", LINES, ids=" ".join)
def test_cells_are_those_of_plain_hydra_or_differ_for_a_reason(line):
    outcome, difference = compare(line, composed=1)
    assert outcome in SAME or reason_for(line, outcome), f"{outcome}: {difference}"


def test_no_reason_explains_equal_cells_or_a_line_without_what_it_names():
    assert len(LINES) >= 100
    assert not any(reason_for(("seed=0,1", "robot=macro,mini"), outcome) for outcome in OUTCOMES)
    assert not {outcome for each in MEANT for outcome in each.outcomes} & {*SAME}


def test_a_difference_is_found():
    assert compare(("noise.position=range(0.1,0.4,0.1)",), composed=1) == ("different", "3 cells, not 4")
    assert compare(("robot=glob(q*)",), composed=1)[0] == "runner refuses"
    assert compare(("seed=1,,2",), composed=1)[0] == "both refuse"
