"""List of all caveat rules in the order of output, and a digest of their source."""

import hashlib
from functools import cache
from pathlib import Path

from runner.metrics.caveats.controller import SHORT_HORIZON, UNSTABLE_CONTACT, UNSTABLE_GAINS
from runner.metrics.caveats.measurement import EXACT_VELOCITY, FIXED_MISMATCH
from runner.metrics.caveats.mjcf import ROBOT_FILE
from runner.metrics.caveats.motion import DID_NOT_FOLLOW, JOINT_LIMITS
from runner.metrics.caveats.payload import NO_EFFORT_LIMIT, OVERLOAD
from runner.metrics.caveats.plant_error import DEFAULT_PLANT
from runner.metrics.caveats.rule import SettingRule, TraceRule
from runner.metrics.caveats.torques import CHATTER, SATURATION

TRACE_RULES: tuple[TraceRule, ...] = (DID_NOT_FOLLOW, SATURATION, CHATTER, JOINT_LIMITS)
SETTING_RULES: tuple[SettingRule, ...] = (
    OVERLOAD, NO_EFFORT_LIMIT, EXACT_VELOCITY, FIXED_MISMATCH, UNSTABLE_GAINS, UNSTABLE_CONTACT, SHORT_HORIZON,
    DEFAULT_PLANT, ROBOT_FILE,
)  # fmt: skip
_HEX = 24


@cache
def rules_digest() -> str:
    """Return a digest of the source of the rules."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:_HEX]
