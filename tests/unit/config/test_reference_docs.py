"""The page of all keys against the models, and types of keys as strings."""

from typing import Annotated, Literal

import pytest
from pydantic import Field, NonNegativeInt, PositiveFloat
from support.recorded_texts import changes

from runner.config.json_schema import meanings
from runner.schema.values import TorquePerStage
from runner.sensing.encoders import NoiseConfig
from tools.docs.allowed_values import describe
from tools.docs.reference import PAGE, reference_text


@pytest.mark.costs(3)
@pytest.mark.bullet  # it holds bullet's keys
def test_the_reference_is_what_the_models_say():
    told = changes("docs/reference.md", PAGE.read_text().splitlines(), reference_text().splitlines())
    assert not told, told


@pytest.mark.parametrize(
    ("annotation", "words"),
    [
        (float, "number"),
        (PositiveFloat, "number above 0"),
        (NonNegativeInt, "whole number of 0 or more"),
        (bool, "`true`, `false`"),
        (float | None, "number, or `null`"),
        (Literal["a", "b"], "`a`, `b`"),
        (Annotated[list[PositiveFloat], Field(min_length=3, max_length=3)], "list of 3 (number above 0)"),
        (Annotated[list[float], Field(min_length=1)], "list of 1 or more (number)"),
        (dict[str, PositiveFloat], "by name: number above 0"),
        (TorquePerStage | None, "number above 0, or a list with one for each joint, by stage, or `null`"),
    ],
)
def test_a_type_is_told_in_words(annotation, words):
    assert describe(annotation) == words


def test_meanings_are_those_of_the_docstring():
    assert set(meanings(NoiseConfig)) == set(NoiseConfig.model_fields)
    assert meanings(NoiseConfig)["distribution"] == "Distribution of the noise; with none, `position` has no effect."
