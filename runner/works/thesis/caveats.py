"""The caveats that are expected of the runs of this work."""

from runner.reporting.expected_caveats import ExpectedCaveat

_GOAL = (
    "A goal that is given at once asks for more than 50 N m at the start and beside the base axis, as in the thesis."
)
_AXIS = "The straight path passes the base axis, where joint 1 is at its limit whatever the controller (claim 3)."
_GOALS = "The Mini follows a series of goals, of which each asks for its limit of 5 N m."
_FOLDED = "The Macro is sent to the tip's goal, the Mini folds, and the control is lost: what these runs are to show."
_HEAVY = "The Mini is made heavier until one-way control breaks: what these runs are to show."
_TURNS = "One arm waits while the other moves: what taking turns costs is what these runs are to show."
_SHORT = "The duration is made so short that joint 1 cannot follow past the base axis: what these runs are to show."

EXPECTED = (
    ExpectedCaveat("exact_velocity", "*", "The thesis adds noise to joint positions alone."),
    *(
        ExpectedCaveat("saturation", runs, _GOAL)
        for runs in (
            "figure_3_5/*",
            "similarity/macro",
            "macro_alone_goal/*",
            "figure_5_8/sound*",
            "figure_5_10/*",
            "coupling/goal/*",
            "whole_body/goal/*",
            "folding/*/minus_home/goal",
            "stretch/*",
            "turns/*/goal/both",
        )
    ),
    *(
        ExpectedCaveat("saturation", runs, _AXIS)
        for runs in (
            "figure_3_9/*",
            "base_axis",
            "figure_5_3/*",
            "macro_alone/*",
            "figure_5_12/sound*",
            "coupling/quintic/*",
            "whole_body/quintic/*",
            "folding/*/minus_home/quintic",
            "turns/*/quintic/both",
            "turns/[0-9]*/both",
            "vanishing/*",
            "bandwidth/*",
            "independent_base/*",
        )
    ),
    ExpectedCaveat("chatter", "figure_3_5/sound", "Joint 1 swings about its limit beside the base axis."),
    *(
        ExpectedCaveat(rule, f"figure_{figure}/as_reported*", _GOALS)
        for figure in ("5_8", "5_12")
        for rule in ("saturation", "chatter")
    ),
    *(ExpectedCaveat(rule, "folding/*/tip_goal/*", _FOLDED) for rule in ("saturation", "chatter")),
    *(ExpectedCaveat(rule, "mass_noise/*", _HEAVY) for rule in ("saturation", "chatter")),
    ExpectedCaveat("saturation", "mass/*", f"Joint 1 is at its limit beside the base axis (claim 3). {_HEAVY}"),
    ExpectedCaveat("did_not_follow", "mass/*", _HEAVY),
    *(ExpectedCaveat(rule, "turns/*/turns", _TURNS) for rule in ("saturation", "chatter")),
    *(ExpectedCaveat("did_not_follow", f"figure_3_9/*/{t_f}", _SHORT) for t_f in ("1.5", "2.0")),
)
