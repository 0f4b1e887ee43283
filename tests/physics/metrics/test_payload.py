"""Caveat of an arm's load: masses carried against the arm's own."""

import pytest
from support.caveat_runs import found


@pytest.mark.parametrize(
    ("overrides", "rule", "text"),
    [
        (("robot=xarm7", "robot.payload.mass=3.5"), None, ""),
        (
            ("robot=xarm7", "robot.payload.mass=7"),
            "overload",
            "the payload weighs 7 kg, 2 times the 3.5 kg that xarm7 is rated for",
        ),
        (
            ("robot=meca500", "robot.tool.mass=0.7", "robot.payload.mass=0.05"),
            "overload",
            "tool and payload weigh 0.75 kg, 1.5 times the 0.5 kg that meca500 is rated for",
        ),
        (("robot=xarm7", "robot.payload.mass=7", "caveats.overload.share=2"), None, ""),
        (
            ("robot=macro", "robot.payload.mass=500"),
            "no_effort_limit",
            "macro lifts 500 kg, and would lift anything: no joint has a torque limit",
        ),
        (("robot=macro", "robot.payload.mass=500", "torque_limits.max=50"), None, ""),
        (("robot=macro", "robot.payload.mass=1", "caveats.no_effort_limit.payload=1"), None, ""),
    ],
)
def test_what_an_arm_carries(checked_config, overrides, rule, text):
    caveats = found(checked_config(*overrides))
    assert list(caveats) == ([rule] if rule else [])
    assert not rule or caveats[rule].text == text
