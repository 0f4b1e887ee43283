"""Memory layout of a program: consecutive indices in the order of allocation."""

from runner.symbolic.code import GIVEN, PARS, ROWS, SCRATCH, STATE, TABLE
from runner.symbolic.expression import Expression, place


class Slots:
    """Slots in the spaces of one program; see runner/symbolic/code.py."""

    def __init__(self) -> None:
        self.widths = {GIVEN: 0, ROWS: 0, STATE: 0, SCRATCH: 0, PARS: 0, TABLE: 3}
        """How many of each space are taken."""

    def take(self, space: str, count: int) -> tuple[int, list[Expression]]:
        """Return the first of some new places, and what stands there."""
        first = self.widths[space]
        self.widths[space] += count
        return first, [place(space, first + index) for index in range(count)]

    def number(self, value: float) -> Expression:
        """Return what stands for a number that may change from run to run: the next parameter; see Values."""
        return self.take(PARS, 1)[1][0]
