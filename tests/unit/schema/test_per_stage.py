"""Values per stage: one for an arm, a mapping for several, and the values that a field takes."""

import pytest
from pydantic import TypeAdapter, ValidationError

from runner.base.errors import ConfigError
from runner.schema.values import FinitePerStage, NonNegativePerStage, PositivePerStage, SpringPerStage, by_stage

STAGES = ["macro", "mini"]


def test_one_stage_takes_one_value():
    assert by_stage("key", 3.0, ["arm"]) == [3.0]


def test_a_mapping_is_taken_in_the_order_of_the_stages():
    assert by_stage("key", {"mini": 2.0, "macro": 1.0}, STAGES) == [1.0, 2.0]


@pytest.mark.parametrize(
    ("value", "stages", "text"),
    [
        (3.0, STAGES, r"key: needs a value for each stage \(macro, mini\); found 3.0"),
        ({"macro": 1.0}, ["macro"], r"key: the robot has one stage \(macro\) and takes one value"),
        ({"makro": 1.0, "mini": 2.0}, STAGES, r"key\.makro: no such stage.*macro"),
        ({"macro": 1.0}, STAGES, r"key\.mini: missing; stages: macro, mini"),
    ],
)
def test_what_does_not_fit_the_stages_is_an_error(value, stages, text):
    with pytest.raises(ConfigError, match=text):
        by_stage("key", value, stages)


@pytest.mark.parametrize(
    ("kind", "good", "bad", "text"),
    [
        (FinitePerStage, -1, "1", "must be a number"),
        (FinitePerStage, {"macro": 0.0}, float("inf"), "must be a finite number"),
        (PositivePerStage, {"macro": 1}, {"macro": 0.0}, "macro must be above 0"),
        (NonNegativePerStage, 0, -1e-9, "must be 0 or more"),
        (SpringPerStage, [None, 2.0], [None, -2.0], "must be a number above 0, null for rigid joints"),
    ],
)
def test_fields_take_their_values_alone(kind, good, bad, text):
    field = TypeAdapter(kind)
    assert field.validate_python(good) == good
    with pytest.raises(ValidationError, match=text):
        field.validate_python(bad)
