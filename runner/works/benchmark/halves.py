"""What the chapter on other seeds and tunings calls: the leads of one half of the runs against those of the other."""

from collections.abc import Mapping, Sequence

from runner.reporting.job import LeftOutError
from runner.reporting.measured import Measured
from runner.store import Run
from runner.works.benchmark.cells import tuned
from runner.works.benchmark.made import all_cells, arms_of

_TUNINGS = 3  # of a half


def said_again(runs: Mapping[str, Run]) -> Measured:
    """Return of the leads that one half shows the share that the other half shows, too, in per cent."""
    said, again, _ = halves(runs)
    return Measured("leads that the other half shows, too", 100.0 * again / said if said else None, "%")


def said_otherwise(runs: Mapping[str, Run]) -> Measured:
    """Return how many leads of one half the other half shows the other way round."""
    return Measured("leads that the other half turns round", float(halves(runs)[2]))


def halves(runs: Mapping[str, Run]) -> tuple[int, int, int]:
    """Return how many drawn leads each half shows, and of these the other one, too, or turned round.

    A half is half of the seeds with the gains of three tunings; it is held against the other half of the seeds with
    the gains of the other three.

    Raises:
        LeftOutError: if there are fewer than six tunings.
    """
    gains = tuned(runs)
    if len(gains) < 2 * _TUNINGS:
        raise LeftOutError(f"{2 * _TUNINGS} tunings, as each half has {_TUNINGS}; it has {len(gains)}")
    ones, others = gains[:_TUNINGS], gains[_TUNINGS : 2 * _TUNINGS]
    even, odd = slice(0, None, 2), slice(1, None, 2)
    said = again = turned = 0
    for one, other in ((even, odd), (odd, even)):
        a, b = _shown(runs, one, ones), _shown(runs, other, others)
        said += len(a) + len(b)
        again += 2 * len(a & b)
        turned += 2 * len({(arm, name, (behind, law)) for arm, name, (law, behind) in a} & b)
    return said, again, turned


def _shown(runs: Mapping[str, Run], seeds: slice, gains: Sequence[str]) -> set[tuple[str, str, tuple[str, str]]]:
    return {
        (arm, name, key)
        for arm in arms_of(runs)
        for name, cell in all_cells(runs, arm, gains, seeds).items()
        for key, lead in cell.leads.items()
        if lead.shown and lead.p_value is not None
    }
