"""The caveats that are expected of the runs of this work."""

from runner.reporting.expected_caveats import ExpectedCaveat

EXPECTED: tuple[ExpectedCaveat, ...] = ()
