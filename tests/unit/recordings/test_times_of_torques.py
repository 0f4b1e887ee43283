"""When a torque acts, by the column map."""

import pytest

from runner.recordings.columns_map import ColumnsMap


@pytest.mark.parametrize(
    ("side", "torque", "held"),
    [("motor", None, True), ("link", None, False), ("link", "held", True), ("motor", "instant", False)],
)
def test_torque_sensors_on_the_link_side_measure_an_instant(side, torque, held):
    said = ColumnsMap(rate=100.0, columns={"a": {"torque": "q1", "unit": "N m", "side": side}}, torque=torque)
    assert said.held is held


@pytest.mark.parametrize("side", [None, "motor", "link"])
@pytest.mark.parametrize(("torque", "held"), [(None, True), ("held", True), ("instant", False)])
def test_a_commanded_torque_is_held_unless_the_map_says_otherwise(side, torque, held):
    column = {"torque": "q1", "unit": "N m", "holds": "commanded", "side": side}
    assert ColumnsMap(rate=100.0, columns={"a": column}, torque=torque).held is held
