"""A hundred lines by plain Hydra and by the runner: the cells differ only where a difference is meant."""

import pytest
from hydra import compose as hydra_compose
from hydra import initialize_config_dir

from runner.base.paths import conf_dir
from runner.config.compose.compose import resolve
from runner.config.compose.sources import VERSION_BASE, checked_sources
from runner.config.compose.unresolved import from_hydra
from tools.plain_hydra.cells import compose_plain
from tools.plain_hydra.comparison import OUTCOMES, compare
from tools.plain_hydra.lines import drawn, written
from tools.plain_hydra.meant import MEANT, reason_for

SAME = OUTCOMES[:2]
LINES = [*written()[::2], *drawn(36, 68, ["noise"])]


@pytest.mark.costs(10)
def test_cells_are_those_of_plain_hydra_or_differ_for_a_reason():
    assert len(LINES) >= 100
    found = [(line, *compare(line, composed=1)) for line in LINES]
    assert [each for each in found if each[1] not in SAME and not reason_for(each[0])] == []


@pytest.mark.costs(1)
def test_no_reason_explains_cells_that_are_not_meant(monkeypatch):
    line = ("robot=mini", "robot={settling_band:0.002}", "seed=0,1")
    assert (
        reason_for(line)
        == "an option and a mapping of one group both count, as in a single run; Hydra keeps the later one"
    )
    monkeypatch.setattr("tools.plain_hydra.meant.of_runner", lambda line, _: (1, [compose_plain(["robot=mini"])]))
    assert reason_for(line) == ""
    monkeypatch.setattr("tools.plain_hydra.meant.of_runner", lambda line, _: "runner: refused in other words")
    assert not any(reason_for(line) for line in [*LINES, ("experiment=sweep/a,sweep/b",)])


@pytest.mark.costs(1)
def test_a_reason_needs_what_it_names():
    assert not reason_for(("seed=0,1", "robot=macro,mini"))
    assert all(row.instead is None or not row.refusal for row in MEANT)


@pytest.mark.costs(1)
def test_a_difference_is_found():
    assert compare(("robot=mini", "robot={settling_band:0.002}", "seed=0,1"))[0] == "different"
    assert compare(("robot=glob(q*)",), composed=1)[0] == "runner refuses"
    assert compare(("seed=1,,2",), composed=1)[0] == "both refuse"
    assert compare(("seed=range(0,2.5)",), composed=1)[0] == "different"


@pytest.mark.parametrize("job", [["robot=mini", "seed=3"], ["noise={bias:0.1}", "robot=mini", "~noise.position"]])
def test_plain_composition_is_that_of_hydras_own_function(job):
    with checked_sources([]), initialize_config_dir(str(conf_dir()), job_name="runner", **VERSION_BASE):
        config = hydra_compose("config", job, return_hydra_config=True)
    assert compose_plain(job) == resolve(from_hydra(config), job, ()).resolved
