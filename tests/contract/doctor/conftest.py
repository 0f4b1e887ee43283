"""An arm and the signals of its log, for tests of what the doctor says of logs."""

import pytest
from support import log_files as made

from runner.assembly.validation import validate
from runner.config.compose.compose import compose


@pytest.fixture(scope="module")
def arm():
    return validate(compose(["robot=ur5e"])).arm.model


@pytest.fixture(scope="module")
def signals(arm):
    return made.arm_signals(arm)
