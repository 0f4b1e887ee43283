"""Meanings of keys against the docstrings of their models."""

from runner.config.compose.documentation import meanings
from runner.config.noise import NoiseConfig


def test_meanings_are_those_of_the_docstring():
    assert set(meanings(NoiseConfig)) == set(NoiseConfig.model_fields)
    assert meanings(NoiseConfig)["distribution"] == "Its shape; with none, `position` has no effect."
