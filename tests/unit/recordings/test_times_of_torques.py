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
