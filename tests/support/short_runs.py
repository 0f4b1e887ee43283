"""Overrides of runs that take no time, for the tests of tuning."""

SHORT = ("robot=macro", "trajectory=quintic", "duration=0.05")
FREQUENCY = "controller.natural_frequency=tag(log,interval(5,80))"
DAMPING = "controller.damping_ratio=interval(0.3,2)"
