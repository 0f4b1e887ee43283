"""Replication of the benchmark's leads: one half of the seeds compared with the other."""

from collections.abc import Mapping

from runner.store import Run
from runner.studies.benchmark.made import all_cells, arms_of
from runner.study.measured import Measured


def said_again(runs: Mapping[str, Run]) -> Measured:
    """Return of the leads that one half shows the share that the other half shows, too, in per cent."""
    said, again, _ = halves(runs)
    return Measured("leads that the other half shows, too", 100.0 * again / said if said else None, "%")


def said_otherwise(runs: Mapping[str, Run]) -> Measured:
    """Return how many leads of one half the other half shows the other way round."""
    return Measured("leads that the other half turns round", float(halves(runs)[2]))


def halves(runs: Mapping[str, Run]) -> tuple[int, int, int]:
    """Return how many drawn leads the halves show, and of these the other one, too, or turned round.

    They are those of the first question, which has seeds enough for two halves.
    """
    a, b = (_shown(runs, slice(start, None, 2)) for start in (0, 1))
    turned = {(arm, name, (behind, law)) for arm, name, (law, behind) in a} & b
    return len(a) + len(b), 2 * len(a & b), 2 * len(turned)


def _shown(runs: Mapping[str, Run], seeds: slice) -> set[tuple[str, str, tuple[str, str]]]:
    return {
        (arm, name, key)
        for arm in arms_of(runs)
        for name, cell in all_cells(runs, arm, seeds=seeds).items()
        for key, lead in cell.leads.items()
        if lead.shown and lead.p_value is not None
    }
