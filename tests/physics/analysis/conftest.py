"""Analyses of runs, one for each config in a session."""

from functools import cache

import pytest

from runner.analysis import GROUPS, analyse
from runner.config.compose.compose import compose


@pytest.fixture(scope="session")
def analysed():
    @cache
    def found(*overrides, groups=GROUPS):
        return analyse(compose(overrides), groups)

    return found
