"""The laws and their inputs, tuned gains, and those near the ends of their ranges."""

import itertools
from collections.abc import Mapping

import numpy as np

from runner.base.quantities import number, quantity
from runner.papers.studies.benchmark.cells import UNTUNED, tuned
from runner.papers.studies.benchmark.figures import any_origin
from runner.papers.studies.benchmark.made import ARMS, LAWS, QUESTIONS, arms_of, laws_of
from runner.papers.study.results import Runs, matching_runs
from runner.papers.study.tunings import Ranges, key_of
from runner.reporting.document import Table, Text
from runner.reporting.table import Column, numbers
from runner.reporting.words import in_words
from runner.sweeps.differing import entries

_LAW_KEYS = ("controller.", "disturbance_observer.")
_UNKNOWN, _LEARNING = "not known here", "iterative_learning"


def laws(runs: Runs, caption: str) -> Table:
    """Return a table of what each law does and reads, and of the time of its control tick on the engine's Macro."""
    rows = []
    for law in (*laws_of(runs, arms_of(runs)[0]), _LEARNING):
        does, model, friction, repeats = LAWS.get(law, ("A law from outside.", *(_UNKNOWN,) * 3))
        sensor = "no" if law in LAWS else _UNKNOWN
        timed = [] if law == _LEARNING else matching_runs(runs, f"engine/{{arm}}/{law}/{{task}}/exact/{{gains}}")
        taken = [each for each in (one.run.record["timing"].get("tick_time_median") for one in timed) if each]
        tick = quantity(float(np.median(taken)), "s", 2) if taken else "–"
        rows.append([in_words(law), does, model, friction, sensor, repeats, tick])
    header = ["law", "what it does", "model", "friction", "torque sensor", "that a motion repeats", *numbers("tick")]
    return Table(caption, header, rows)


def arm_words() -> dict[str, str]:
    """Return the names of the arms by level."""
    return ARMS


def at_ends(runs: Runs, ranges: Mapping[str, Ranges], caption: str) -> Table | Text:
    """Return the tuned values near an end of their range as a table; a sentence where there are none."""
    rows = values_at_ends(runs, ranges)
    if not rows:
        return Text(f"{caption} Here there are none.")
    header = ["law", "arm", "question", "tuning", "key", *numbers("value"), "where"]
    return Table(caption, header, rows, any_origin(runs))


def values_at_ends(runs: Runs, ranges: Mapping[str, Ranges]) -> list[list[str]]:
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


def gains(runs: Runs, caption: str) -> Table:
    """Return the gains of each law and arm that were tuned: of its bandwidth, and of each tuning."""
    rows, tunings = [], [(question, own) for question in QUESTIONS for own in tuned(runs)]
    for arm in arms_of(runs):
        for law in laws_of(runs, arm):
            every = [keys_of(runs, arm, law, *own) for own in (("first", *UNTUNED), *tunings)]
            for key in (key for key in every[0] if len({own.get(key) for own in every}) > 1):
                rows.append([ARMS[arm], in_words(law), key, *(number(float(own[key])) for own in every)])
    tuned_by = (f"{question}, {own}" for question, own in tunings)
    header = ["arm", "law", Column("key", "code"), *numbers("not tuned", *tuned_by)]
    return Table(caption, header, rows, any_origin(runs), folded=True)


def keys_of(runs: Runs, arm: str, law: str, question: str, gains: str) -> dict[str, str]:
    """Return the keys of a law and its observer with their values, as strings, of a tuning."""
    config = matching_runs(runs, f"{question}/{arm}/{law}/{{task}}/exact/{gains}")[0].run.config
    own = {group: config[group] for group in ("controller", "disturbance_observer") if group in config}
    return {key: value for key, value in entries(own) if key.startswith(_LAW_KEYS)}
