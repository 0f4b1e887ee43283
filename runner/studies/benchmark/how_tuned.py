"""Tuned values near the ends of their ranges."""

import itertools
from collections.abc import Mapping

from runner.base.quantities import number
from runner.reporting.document import Table, Text
from runner.reporting.table import numbers
from runner.reporting.words import in_words
from runner.studies.benchmark.by_law import keys_of
from runner.studies.benchmark.cells import UNTUNED, tuned
from runner.studies.benchmark.figures import any_origin
from runner.studies.benchmark.made import ARMS, QUESTIONS, arms_of, laws_of
from runner.study.results import Runs
from runner.study.tunings import Ranges, key_of


def at_ends(runs: Runs, ranges: Mapping[str, Ranges], caption: str) -> Table | Text:
    """Return the tuned values near an end of their range as a table; a sentence where there are none; see ends_of."""
    rows = ends_of(runs, ranges)
    if not rows:
        return Text(f"{caption} Here there are none.")
    header = ["law", "arm", "question", "tuning", "key", *numbers("value"), "where"]
    return Table(caption, header, rows, any_origin(runs))


def ends_of(runs: Runs, ranges: Mapping[str, Ranges]) -> list[list[str]]:
    """Return a row for each tuned value near an end of its range: law, arm, question, tuning, key, value, end.

    Args:
        runs: The runs of the study.
        ranges: The ranges of each tuning of its runs.yaml, by name.
    """
    rows = []
    for arm, question in itertools.product(arms_of(runs), QUESTIONS):
        for law in laws_of(runs, arm):
            before = keys_of(runs, arm, law, "first", *UNTUNED)
            tuned_keys = ranges[f"{question}/{arm}/{law}"]
            own_ranges = {name: own for name, own in tuned_keys.items() if before.get(name, "null") != "null"}
            for own in tuned(runs):
                after = keys_of(runs, arm, law, question, own)
                place = [in_words(law), ARMS[arm], QUESTIONS[question], own]
                if own_ranges and all(before[name] == after[name] for name in own_ranges):
                    rows.append([*place, ", ".join(own_ranges), "as before", "gains of the bandwidth"])
                for name, factors in own_ranges.items():
                    end = key_of(name, float(before[name]), factors).end_near(float(after[name]))
                    if end:
                        rows.append([*place, name, number(float(after[name])), f"{end} end"])
    return rows
