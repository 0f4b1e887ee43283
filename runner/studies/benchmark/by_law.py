"""Benchmark chapter by controller: required model data, gains, rank and computing time."""

from collections.abc import Sequence

import numpy as np

from runner.base.quantities import number
from runner.reporting.document import Block, Section, Table, Text
from runner.reporting.table import Column, numbers
from runner.reporting.words import in_words
from runner.studies.benchmark.cells import UNTUNED, tuned
from runner.studies.benchmark.figures import any_origin, error_words, ratio
from runner.studies.benchmark.made import ARMS, CONDITIONS, LAWS, QUESTIONS, all_cells, arms_of, laws_of
from runner.study.results import Runs, found
from runner.sweeps.differing import entries

_UNKNOWN = "not known here"
_LAW_KEYS = ("controller.", "disturbance_observer.")


def section(runs: Runs) -> Section:
    """Return the chapter."""
    text = (
        "All laws read positions and velocities of the joints; none of them reads torque sensors. Untuned gains follow "
        "from one bandwidth for each arm; tuned ones are the best of the same number of trials for every law, for each "
        "question, by different seeds."
    )
    laws = laws_of(runs, arms_of(runs)[0])
    return Section("Law by law", (Text(text), _knowledge(runs, laws)), [_law(runs, law) for law in laws])


def _knowledge(runs: Runs, laws: Sequence[str]) -> Table:
    """Return a table of the inputs of each law; iterative learning has a separate chapter."""
    rows = []
    for law in (*laws, "iterative_learning"):
        _, model, friction, repeats = LAWS.get(law, (_UNKNOWN,) * 4)
        rows.append([in_words(law), model, friction, "no" if law in LAWS else _UNKNOWN, repeats])
    header = ["law", "model", "friction", "torque sensor", "that a motion repeats"]
    return Table("Inputs of each law, besides the joints' positions and velocities.", header, rows)


def _law(runs: Runs, law: str) -> Section:
    words = in_words(law)
    blocks: list[Block] = [
        Text(LAWS[law][0] if law in LAWS else "A law from outside."),
        _places(runs, law),
        _gains(runs, law),
    ]
    cost = _cost(runs, law)
    return Section(words[0].upper() + words[1:], [*blocks, Text(cost)] if cost else blocks)


def _places(runs: Runs, law: str) -> Table:
    """Return its error and group under each condition on each arm, and how much of the error tuning took away."""
    rows = []
    for arm in arms_of(runs):
        before = all_cells(runs, arm, gains=UNTUNED)
        for question, words in QUESTIONS.items():
            for name, cell in all_cells(runs, arm, question).items():
                entry = cell.entry(law)
                group = next(str(place) for place, own in enumerate(cell.groups, start=1) if law in own)
                behind = ratio(entry, cell.best)
                gained = ratio(before[name].entry(law), entry) if question == "first" else None
                texts = ["beyond" if behind is None else number(behind, zeros=True)]
                texts.append("" if question != "first" else "beyond" if gained is None else number(gained, zeros=True))
                rows.append([ARMS[arm], words, CONDITIONS[name], error_words(entry), group, *texts])
    header = ["arm", "question", "condition", *numbers("error", "group", "over the smallest", "untuned over tuned")]
    return Table(f"{in_words(law)}: errors and groups.", header, rows, any_origin(runs), folded=True)


def _gains(runs: Runs, law: str) -> Table:
    """Return the gains of each arm: of its bandwidth, and of each tuning."""
    rows = []
    tunings = [(question, own) for question in QUESTIONS for own in tuned(runs)]
    for arm in arms_of(runs):
        by_gains = [keys_of(runs, arm, law, "first", *UNTUNED), *(keys_of(runs, arm, law, *own) for own in tunings)]
        differing = [key for key in by_gains[0] if len({own.get(key) for own in by_gains}) > 1]
        for key in differing or ["none"]:
            rows.append([ARMS[arm], key, *(_short(own.get(key, "")) for own in by_gains)])
    tuned_by = (f"{question}, {own}" for question, own in tunings)
    header = ["arm", Column("key", "code"), *numbers("not tuned", *tuned_by)]
    caption = f"{in_words(law)}: gains that were tuned, by question and tuning."
    return Table(caption, header, rows, any_origin(runs))


def keys_of(runs: Runs, arm: str, law: str, question: str, gains: str) -> dict[str, str]:
    """Return the keys of a law and its observer with their values, as strings, of a tuning."""
    config = found(runs, f"{question}/{arm}/{law}/{{task}}/exact/{gains}")[0].run.config
    own = {group: config[group] for group in ("controller", "disturbance_observer") if group in config}
    return {key: value for key, value in entries(own) if key.startswith(_LAW_KEYS)}


def _short(value: str) -> str:
    try:
        return number(float(value))
    except ValueError:
        return value


def _cost(runs: Runs, law: str) -> str:
    """Return a sentence on the time of one tick on the engine's Macro; empty if no clock was read."""
    timed = [one.run.record["timing"].get("tick_time_median")
             for one in found(runs, f"engine/{{arm}}/{law}/{{task}}/exact/{{gains}}")]  # fmt: skip
    taken = [each for each in timed if each]
    if not taken:
        return ""
    return (
        f"A control tick of it took {number(1e6 * float(np.median(taken)), 2)} µs on the Macro, law and plant, in "
        "its runs: a clock's reading, which another machine does not repeat."
    )
