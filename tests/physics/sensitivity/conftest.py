"""Analyses of runs, one for each config in a session."""

from functools import cache

import pytest

from runner.config.compose import compose
from runner.config.validation import validate
from runner.sensitivity import GROUPS, analyse


@pytest.fixture(scope="session")
def analysed():
    @cache
    def found(*overrides, groups=GROUPS):
        return analyse(validate(compose(overrides).resolved), validate, groups)

    return found
