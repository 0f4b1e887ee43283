"""Readable names for metrics, presets, plants, controllers and variants, from `names.yaml`."""

import re
from collections.abc import Sequence
from pathlib import Path

from runner.base.data_file import read_data

NAMES = read_data(Path(__file__).with_name("names.yaml"), dict[str, dict[str, str]])
"""Readable name of each metric, preset (in the order of the studies' columns), plant and other, by group."""
PRESET, PLANT = NAMES["presets"], NAMES["plants"]
_IN_WORDS = PRESET | PLANT | NAMES["others"]
_CODE_NAME = re.compile(rf"\b({'|'.join(_IN_WORDS)})\b")


def in_words(name: str) -> str:
    """Return a preset, plant, coupling or variant, such as "full_equations, decoupled", as a readable name."""
    return _CODE_NAME.sub(lambda found: _IN_WORDS[found[0]], name)


def join_values(values: Sequence[str]) -> str:
    """Return values as a list, separated by semicolons if one of them has a comma."""
    return ("; " if any("," in value for value in values) else ", ").join(values)
