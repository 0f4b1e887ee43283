"""The caveats that are expected of the runs of this work."""

from runner.reporting.expected_caveats import ExpectedCaveat

_MISPRINTED = "A Jacobian whose columns are misprinted moves the tip elsewhere: what these runs are to show."
_LOADED = "The payload is raised until joint 2 cannot bear it: what these runs are to show."

EXPECTED = (
    ExpectedCaveat("did_not_follow", "printed/*/columns*", _MISPRINTED),
    ExpectedCaveat("joint_limits", "printed/*/columns*/fed back", f"{_MISPRINTED} Nothing stops joints here."),
    ExpectedCaveat("saturation", "printed/pose/columns*/fed back", _MISPRINTED),
    ExpectedCaveat("overload", "payload/*/5", "5 kg is taken to show what lies beyond the rating."),
    ExpectedCaveat("saturation", "payload/*", _LOADED),
    ExpectedCaveat("did_not_follow", "payload/*", _LOADED),
    ExpectedCaveat("saturation", "torque/*", _LOADED),
    ExpectedCaveat("did_not_follow", "torque/computed_torque/*", _LOADED),
    ExpectedCaveat("chatter", "torque/computed_torque/*", _LOADED),
    ExpectedCaveat("joint_limits", "torque/computed_torque/*", f"{_LOADED} An arm that gives way passes its limits."),
)
