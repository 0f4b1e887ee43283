"""The report on a tuning: real runs of no length, judged by functions of their keys."""

import math
from dataclasses import replace

import numpy as np
import pytest

from runner.base.errors import StoreError
from runner.reporting.document import Curves, Notice, Playback, RunList, Table, Text
from runner.reporting.markup import literal
from runner.reporting.sweep.tuning import TuningSubject, history_section, tuning_document
from runner.sweeps.tuning.objective import Objective, Trial
from runner.sweeps.tuning.run import tune
from runner.sweeps.tuning.study import at_ends

GOALS = (Objective("peak_torque", "minimize"), Objective("rms_torque", "maximize"))
KEYS = ("controller.natural_frequency=tag(log,interval(5,80))", "controller.damping_ratio=interval(0.3,2)")


@pytest.fixture(scope="module")
def tuning(tmp_path_factory):
    outputs = tmp_path_factory.mktemp("outputs")
    short = ("robot=macro", "trajectory=quintic", "duration=0.05", f"outputs={outputs}", "hydra.sweeper.workers=0")
    made = tune([*short, *KEYS], GOALS, 22, 2, "runner tune ...")
    return replace(made, trials=[judged(trial) for trial in made.trials])


def judged(trial):
    """Say of a trial that the torque is the key's frequency, to be traded off against damping."""
    frequency, damping = trial.params.values()
    return Trial(trial.params, (frequency, damping - math.log(frequency)), trial.run, "")


def with_failures(tuning):
    first, second, *others = tuning.trials
    worst = (math.inf, -math.inf)
    ended = replace(first, values=worst, failure="diverged, at $once$")
    unmade = Trial(second.params, worst, "", "plant.step: no divisor")
    return replace(tuning, trials=[ended, unmade, *others])


def document(tuning):
    return tuning_document(tuning, tuning.folder.parent.parent / "reports" / "any")


def blocks(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def titles(document):
    return [section.title for section in document.sections]


def section(document, title):
    return document.sections[titles(document).index(title)]


@pytest.mark.costs(2)
def test_the_report_has_its_parts(tuning):
    made = document(tuning)
    assert titles(made) == [
        "Default and tuned",  # nothing is drawn
        "What was tuned",
        "History",
        "Trade-off",
        "Keys",
        "Chosen by each objective",
        "Caveats",
        "All runs",
        "Provenance",
    ]
    assert made.title == "Tuning to minimize the largest torque and maximize the rms torque"
    (table,) = blocks(section(made, "What was tuned"), Table)
    assert table.origin.command == "runner tune ..."
    assert table.rows[0] == ["controller.natural_frequency (rad/s)", "5", "80", "logarithmic", "any"]
    for best in section(made, "Chosen by each objective").sections:
        assert len(blocks(best, Playback)) == 1


def test_one_objective_has_one_best_trial_and_no_trade_off(tuning):
    one = replace(
        tuning,
        study=replace(tuning.study, objectives=GOALS[:1]),
        trials=[replace(trial, values=trial.values[:1]) for trial in tuning.trials],
    )
    made = document(one)
    assert "Trade-off" not in titles(made)
    (best,) = section(made, "Chosen trial").sections
    place = min(range(22), key=lambda number: one.trials[number].values)
    assert best.title == f"Trial {place}"
    (_, trials, _), (what, _, settings) = made.key_numbers
    assert (trials, what.endswith(", chosen")) == ("22", True)
    assert settings.startswith(f"trial {place}: ")
    assert made.cover is not None
    command = blocks(best, Table)[0].origin.command
    assert command.endswith(f"controller.damping_ratio={one.trials[place].params['controller.damping_ratio']!r}")


def test_the_first_paragraph_says_which_key_ends_at_the_end_of_its_range(tuning):
    first, *others = tuning.trials
    lowest = judged(replace(first, params=first.params | {"controller.natural_frequency": 5.0}))  # the least torque
    ended = replace(tuning, trials=[lowest, *others])
    assert at_ends(ended)
    assert literal(" ".join(at_ends(ended))) in document(ended).abstract


def test_the_history_never_gets_worse(tuning):
    less, more = blocks(history_section(TuningSubject(tuning)), Curves)[0].panels
    for panel, sign in ((less, 1.0), (more, -1.0)):
        trials, so_far = panel.series
        assert (np.diff(sign * so_far.y) <= 0).all()
        assert sign * so_far.y[-1] == (sign * trials.y).min()
        assert list(trials.runs) == [trial.run for trial in tuning.trials]


def test_the_front_holds_what_its_table_lists(tuning):
    part = section(document(tuning), "Trade-off")
    _, front = blocks(part, Curves)[0].panels[0].series
    (table,) = blocks(part, Table)
    assert [int(row[0]) for row in table.rows] == TuningSubject(tuning).best
    assert len(front.x) == len(table.rows) > 1
    assert (np.diff(front.x) > 0).all()
    assert (np.diff(front.y) > 0).all()  # less of one costs more of the other


def test_the_key_that_decides_is_said(tuning):
    (table,) = blocks(section(document(tuning), "Keys"), Table)
    shares = {row[0]: float(row[1].split()[0]) for row in table.rows}
    assert shares["controller.natural_frequency"] > shares["controller.damping_ratio"]
    few = replace(tuning, trials=tuning.trials[:19])
    assert blocks(section(document(few), "Keys"), Text)[0].text.startswith("Of fewer than 20 good trials")


def test_failed_trials_are_listed_and_stand_in_no_figure(tuning):
    failed = with_failures(tuning)
    made = document(failed)
    assert blocks(section(made, "What was tuned"), Notice)[0].title == "2 of 22 trials failed"
    (table,) = blocks(section(made, "Failed trials"), Table)
    assert [(row[0], row[3]) for row in table.lines[1:]] == [
        ("0", "diverged, at $$once$$"),
        ("1", "plant.step: no divisor"),
    ]
    for panel in blocks(section(made, "History"), Curves)[0].panels:
        assert panel.series[0].x.min() == 2.0
        assert np.isfinite(panel.series[0].y).all()
    (listing,) = blocks(section(made, "All runs"), RunList)
    assert len(listing.hashes) == 21
    assert listing.failures[0] == "diverged, at $once$"


def test_every_run_is_listed_with_its_trial_keys_and_address(tuning):
    (listing,) = blocks(section(document(tuning), "All runs"), RunList)
    assert [name for name, _ in listing.metrics[:5]] == [
        "trial",
        "peak_torque",
        "rms_torque",
        "controller.natural_frequency",
        "controller.damping_ratio",
    ]
    assert listing.values[:, 0].tolist() == list(range(22))
    assert listing.values[:, 3].tolist() == [trial.params["controller.natural_frequency"] for trial in tuning.trials]
    assert listing.folders[0] == f"../../runs/{tuning.trials[0].run}/"


def test_a_tuning_in_which_all_failed_has_a_report(tuning):
    lost = replace(tuning, trials=[replace(trial, failure="diverged") for trial in tuning.trials], fresh=None)
    assert document(lost).key_numbers == [("trials", "22", "22 of them failed")]
    assert titles(document(lost)) == ["What was tuned", "Failed trials", "Caveats", "All runs", "Provenance"]


@pytest.mark.bullet
def test_the_report_is_as_recorded(tuning, as_recorded):
    as_recorded("reports", "tuning", document(tuning))
    as_recorded("reports", "tuning with failures", document(with_failures(tuning)))


def test_a_run_that_is_gone_is_told(tuning, monkeypatch):
    gone = replace(tuning, trials=[*tuning.trials, replace(tuning.trials[0], run="0" * 24)])
    with pytest.raises(StoreError, match=r"1 of 23 cells of .* are not stored; continue with: runner tune "):
        document(gone)


def test_a_section_of_a_plug_in_is_before_the_details(own_section, tuning):
    own_section("tuning", "f'{len(subject.good)} of {len(subject.made)}'")
    made = document(tuning)
    assert section(made, "Own").blocks[0].text == "22 of 22"
    assert titles(made)[-4:] == ["Own", "Caveats", "All runs", "Provenance"]
