"""Plans of listed runs: each composed like a single run."""

import pytest

from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.compose.composer import Composer
from runner.sweeps.check import check
from runner.sweeps.plan import Item, Listed

ITEMS = {
    "slow": Item(("experiment=thesis/figure_3_9", "preset=full_equations", "trajectory.duration=1.5", "repetitions=2")),
    "slower": Item(
        ("experiment=thesis/figure_3_9", "preset=full_equations", "trajectory.duration=2.0", "repetitions=2")
    ),
    "again": Item(
        ("experiment=thesis/figure_3_9", "preset=full_equations", "trajectory.duration=1.5", "repetitions=2")
    ),
    "other": Item(("experiment=thesis/figure_3_9", "preset=as_reported", "repetitions=1")),
    "rk4": Item(("experiment=thesis/figure_3_9", "preset=full_equations", "plant=rk4", "repetitions=1")),
    "mini": Item(("robot=mini", "noise.position=1e-4")),
    "tool": Item(("calibration=tool_direction", "repetitions=3"), "calibrate"),
}


class CountingLoader(Composer):
    """Notes what it loads."""

    def __init__(self):
        super().__init__()
        self.loaded = []

    def load(self, options, root="config"):
        self.loaded.append(options)
        return super().load(options, root)


@pytest.fixture
def loader():
    return CountingLoader()


@pytest.fixture
def listed(tmp_path, loader):
    return Listed(ITEMS, ["sweep.trace=all", f"outputs={tmp_path}"], loader)


def test_each_is_composed_as_alone(listed, tmp_path):
    for cell, item in enumerate(ITEMS.values()):
        ours, alone = listed.composed(cell), compose(item.overrides, root=item.root)
        trace = {} if item.root == "calibrate" else {"sweep": {**alone.resolved["sweep"], "trace": "all"}}
        assert ours.resolved == {**alone.resolved, "outputs": str(tmp_path), **trace}
        assert ours.choices == alone.choices
        assert (ours.overrides, ours.root) == (item.overrides, item.root)


def test_those_that_choose_the_same_options_are_composed_together(listed, loader, monkeypatch):
    monkeypatch.setattr("runner.sweeps.template.read_kept", lambda *_: None)
    for cell in range(len(listed)):
        listed.composed(cell)
    assert len(loader.loaded) == 5


def test_runs_and_calibrations_are_checked_and_weighed(listed, tmp_path):
    checked = check(listed)
    assert checked.names[0] == checked.names[2]
    assert len(set(checked.names)) == len(ITEMS) - 1
    assert checked.calibrations == {6}
    assert checked.costs[:2].tolist() == [2 * 250, 2 * 300]  # t_f and a second of rest, at 10 ms
    assert checked.outputs == tmp_path


def test_all_problems_are_told_at_once(tmp_path):
    items = {"a": Item(("noise.position=-1",)), "b": Item(("calibration.poses=0",), "calibrate"), "c": ITEMS["mini"]}
    with pytest.raises(ConfigError) as raised:
        check(Listed(items, [f"outputs={tmp_path}"], Composer()))
    first, second = raised.value.problems
    assert first.startswith("[noise.position=-1] noise.position: must be 0 or more")
    assert second.startswith("[calibration.poses=0] ")
