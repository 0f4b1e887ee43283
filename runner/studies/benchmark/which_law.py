"""Error ratios between controllers, and the effect of tuning, on all arms."""

from runner.reporting.words import in_words
from runner.studies.benchmark.cells import UNTUNED
from runner.studies.benchmark.figures import ratio
from runner.studies.benchmark.made import ARMS, CONDITIONS, QUESTIONS, arms_of, one_cell
from runner.study.measured import Measured
from runner.study.results import Runs


def times(runs: Runs, question: str, condition: str, law: str, other: str, *arms: str) -> list[Measured]:
    """Return the error of a law over that of another one on some arms, of all where none is named."""
    return [
        Measured(
            f"error of {in_words(law)} over that of {in_words(other)}, {_where(arm, question, condition)}",
            ratio(cell.entry(law), cell.entry(other)),
        )
        for arm in arms or arms_of(runs)
        for cell in [one_cell(runs, arm, condition, question)]
    ]


def sure_leads(runs: Runs, question: str, condition: str, law: str, other: str, *arms: str) -> list[Measured]:
    """Return the lower end of the interval of another law's error over that of a law, on some arms, or on all.

    A law that is not behind has none.
    """
    told = []
    for arm in arms or arms_of(runs):
        lead = one_cell(runs, arm, condition, question).leads.get((law, other))
        low = None if lead is None or not lead.shown or lead.interval is None else lead.interval[0]
        words = f"{in_words(other)} over {in_words(law)}, {_where(arm, question, condition)}"
        told.append(Measured(f"lower end of the error of {words}", low))
    return told


def in_front(runs: Runs, question: str, condition: str, law: str) -> Measured:
    """Return on how many arms no law is shown to be ahead of a law."""
    there = sum(law in one_cell(runs, arm, condition, question).groups[0] for arm in arms_of(runs))
    return Measured(f"arms on which none is ahead of {in_words(law)}, {_asked(question, condition)}", float(there))


def untuned_over_tuned(runs: Runs, condition: str, law: str) -> list[Measured]:
    """Return the error of a law with the gains of the arm's bandwidth over that with tuned ones, on all arms."""
    told = []
    for arm in arms_of(runs):
        before = one_cell(runs, arm, condition, gains=UNTUNED).entry(law)
        after = one_cell(runs, arm, condition).entry(law)
        words = f"error of {in_words(law)} untuned over tuned, {ARMS[arm]}, {CONDITIONS[condition]}"
        told.append(Measured(words, ratio(before, after)))
    return told


def _where(arm: str, question: str, condition: str) -> str:
    return f"{ARMS[arm]}, {_asked(question, condition)}"


def _asked(question: str, condition: str) -> str:
    return f"{CONDITIONS[condition]}, {QUESTIONS[question]}"
