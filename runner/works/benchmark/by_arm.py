"""The chapter with a section for each arm: who is ahead under each condition, and every error, tuned and not."""

from collections.abc import Mapping, Sequence

from runner.reporting.document import Section, Table, Text
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.benchmark.cells import UNTUNED
from runner.works.benchmark.figures import any_origin, error_words, lead_words
from runner.works.benchmark.made import ARMS, CONDITIONS, all_cells, arms_of, laws_of

_WIDE = 6  # conditions that stand in one table


def section(runs: Mapping[str, Run]) -> Section:
    """Return the chapter."""
    text = (
        "The first table of each arm names the law with the smallest error, the next one, and the laws that it is "
        "shown to be ahead of, with whichever of their tunings. A law is ahead if its error is smaller by more than "
        "2 % on the same seeds, by tests corrected for all comparisons on the arm (Holm); intervals have the level "
        "of their test. Where nothing is drawn there is no interval, and it is ahead if it is so along every path. "
        "Errors are root mean squares of the tip's distance from where it should be, of the median seed, and the "
        "geometric mean over paths and tunings. A repetition that failed counts as an error beyond every number; the "
        "share of these stands beside."
    )
    return Section("Arm by arm", (Text(text),), [_arm(runs, arm) for arm in arms_of(runs)])


def _arm(runs: Mapping[str, Run], arm: str) -> Section:
    title = ARMS[arm].replace("planar", "Planar")
    blocks = [_best(runs, arm), *_errors(runs, arm, (), "tuned"), *_errors(runs, arm, UNTUNED, "not tuned")]
    return Section(title, blocks)


def _best(runs: Mapping[str, Run], arm: str) -> Table:
    header = ["condition", "smallest error", "its error", "next", "error of the next", "ahead of"]
    rows = []
    for condition, cell in all_cells(runs, arm).items():
        best, second = cell.entries[0], cell.entries[1]
        behind = lead_words(cell.leads[best.law, second.law])
        tied = cell.tied
        rest = [in_words(each.law) for each in cell.entries[1:] if each.law not in tied]
        ahead = "all" if not tied else ", ".join(rest) or "none"
        rows.append([CONDITIONS[condition], in_words(best.law), error_words(best), in_words(second.law), behind, ahead])
    return Table(f"{ARMS[arm]}: who is ahead.", header, rows, (2,), any_origin(runs))


def _errors(runs: Mapping[str, Run], arm: str, gains: Sequence[str], words: str) -> list[Table]:
    made = all_cells(runs, arm, gains)
    names = list(made)
    tables = []
    for start in range(0, len(names), _WIDE):
        chosen = names[start : start + _WIDE]
        rows = [[in_words(law), *(error_words(made[name].entry(law)) for name in chosen)] for law in laws_of(runs, arm)]
        header = ["law", *(CONDITIONS[name] for name in chosen)]
        caption = f"{ARMS[arm]}: errors, {words}."
        tables.append(Table(caption, header, rows, range(1, len(header)), any_origin(runs)))
    return tables
