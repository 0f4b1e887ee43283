"""What the first chapter calls: how far laws are ahead, and what tuning is worth, on all arms."""

from collections.abc import Mapping

from runner.reporting.measured import Measured
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.benchmark.cells import UNTUNED
from runner.works.benchmark.figures import ratio
from runner.works.benchmark.made import ARMS, CONDITIONS, arms_of, laws_of, one_cell


def times(runs: Mapping[str, Run], condition: str, law: str, other: str, *arms: str) -> list[Measured]:
    """Return the error of a law over that of another one on some arms, of all where none is named."""
    return [
        Measured(
            f"error of {in_words(law)} over that of {in_words(other)}, {ARMS[arm]}, {CONDITIONS[condition]}",
            ratio(cell.entry(law), cell.entry(other)),
        )
        for arm in arms or arms_of(runs)
        for cell in [one_cell(runs, arm, condition)]
    ]


def sure_leads(runs: Mapping[str, Run], condition: str, law: str, *but: str) -> list[Measured]:
    """Return the lower ends of the intervals of how far all others are behind a law, on all arms but some.

    One that is not behind has none.
    """
    return [
        told
        for other in laws_of(runs, arms_of(runs)[0])
        if other != law
        for told in sure_gains(runs, condition, law, other, *but)
    ]


def sure_gains(runs: Mapping[str, Run], condition: str, law: str, other: str, *but: str) -> list[Measured]:
    """Return the lower end of the interval of how far another one is behind a law, on all arms but some."""
    told = []
    for arm in (each for each in arms_of(runs) if each not in but):
        lead = one_cell(runs, arm, condition).leads.get((law, other))
        low = None if lead is None or lead.interval is None else lead.interval[0]
        words = f"{in_words(other)} over {in_words(law)}, {ARMS[arm]}, {CONDITIONS[condition]}"
        told.append(Measured(f"lower end of the error of {words}", low))
    return told


def ahead_of(runs: Mapping[str, Run], condition: str, law: str) -> Measured:
    """Return how many laws are shown to be ahead of one, on all arms together."""
    cells = [one_cell(runs, arm, condition) for arm in arms_of(runs)]
    ahead = sum(lead.shown for cell in cells for (_, behind), lead in cell.leads.items() if behind == law)
    return Measured(f"laws ahead of {in_words(law)}, {CONDITIONS[condition]}", float(ahead))


def untuned_over_tuned(runs: Mapping[str, Run], condition: str, law: str) -> list[Measured]:
    """Return the error of a law with the gains of the arm's bandwidth over that with tuned ones, on all arms."""
    told = []
    for arm in arms_of(runs):
        before, after = (one_cell(runs, arm, condition, gains).entry(law) for gains in (UNTUNED, ()))
        words = f"error of {in_words(law)} untuned over tuned, {ARMS[arm]}, {CONDITIONS[condition]}"
        told.append(Measured(words, ratio(before, after)))
    return told
