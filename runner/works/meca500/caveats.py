"""The caveats that are expected of the runs of this work."""

from runner.reporting.expected_caveats import ExpectedCaveat

EXPECTED = (
    ExpectedCaveat(
        "saturation",
        "map/kinematic/*",
        "Walls this stiff push back harder than the arm's drives could; here the law alone is held against its own "
        "eigenvalues, with joints that go where they are told.",
    ),
    *(
        ExpectedCaveat(
            rule,
            "map/bullet/*",
            "Walls on both sides of the bound are tried; where contact bounces a servo gives all it has.",
        )
        for rule in ("unstable_contact", "saturation", "joint_limits")
    ),
    ExpectedCaveat(
        "saturation",
        "limit/*",
        "The tool is pulled to where the arm cannot go: what these runs are to show is what the law says of it.",
    ),
)
