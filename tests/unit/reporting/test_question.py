"""First question and answer of a sweep, from sweeps whose differences are known."""

from dataclasses import replace

import numpy as np
from support.sample_sweep import measurements

from runner.reporting.answers import sentences
from runner.reporting.sweep.question import asked_axis, causes, find_answers, in_short, too_few
from runner.reporting.sweep.subject import choose
from runner.sweeps.differing import Difference

AXES = {"noise.position": [1e-4, 1e-3], "controller": ["computed_torque", "operational_space"]}


def drawn(repetitions, *key):
    return np.random.default_rng([repetitions, *key]).normal(size=repetitions)


def sweep(repetitions=8, axes=AXES, **metrics):
    """Laws that are wrong alike except for their draws, and whose torques turn over between the levels of noise."""
    given = metrics or {
        "max_tracking_error": lambda noise, law, *_: np.exp(drawn(repetitions) + 0.3 * drawn(repetitions, law)),
        "peak_torque": lambda noise, law, *_: 50.0 + law * (20.0 if noise else -10.0) + drawn(repetitions, law, noise),
    }
    return choose(measurements(axes, given))


def test_asked_is_about_choices_overall_and_at_each_value_of_the_axis_that_spreads_most():
    axes = {**AXES, "torque_limits.max": [20.0, 40.0]}
    given = {"max_tracking_error": lambda noise, law, limit: 1.0 + limit + 0.1 * noise + drawn(8, law) / 100.0}
    subject = choose(measurements(axes, given))
    assert asked_axis(subject).name == "controller"
    answers = [one for one in find_answers(subject) if one.metric == "max_tracking_error"]
    assert [one.at for one in answers] == [{}, {"torque_limits.max": "20"}, {"torque_limits.max": "40"}]
    assert {one.comparison.n for one in answers} == {8}


def test_no_winner_is_named_where_pairs_show_none_and_what_turns_over_is_told():
    error, torque = sentences(find_answers(sweep()))
    assert "no difference between computed_torque (" in error
    assert "smaller" not in error
    assert "operational_space is smaller by" in torque
    assert "at noise.position=0.0001, larger by" in torque


def test_the_end_of_a_sweep_tells_the_first_answer():
    assert in_short(sweep()).startswith("Largest tracking error: no difference between computed_torque (")


def test_a_shown_difference_names_what_goes_with_the_axis():
    plain = sweep()
    keys = ["a", "b", "c", "d"]
    found = [Difference(key, ("controller",), [("computed_torque", "1"), ("operational_space", "2")]) for key in keys]
    subject = replace(plain, measurements=replace(plain.measurements, differences=found))
    (told,) = causes(subject, find_answers(subject))
    assert told == "a, b, c and 1 more vary with controller and may be the cause: see Also differs."


def test_too_few_repetitions_say_what_they_cannot_show_and_name_no_cell():
    subject = sweep(repetitions=5)
    expected = "With 5 pairs no difference can be shown: 6 are the fewest, as by repetitions=6."
    assert too_few(subject) == expected
    assert expected in in_short(subject)
    assert "computed_torque" not in in_short(subject)
    assert too_few(sweep(repetitions=6)) == ""


def test_of_several_values_the_first_six_are_told():
    laws = ["a", "b", "c", "d", "e", "f", "g", "h", "i"]
    given = {"max_tracking_error": lambda law: 1.0 + law + drawn(20, law) / 100.0}
    subject = choose(measurements({"controller": laws}, given))
    told = sentences(find_answers(subject))
    assert [text.split(" with ")[1][0] for text in told[:6]] == ["b", "c", "d", "e", "f", "g"]
    assert told[6] == "2 more are in the tables."
    assert in_short(subject).startswith("largest tracking error: medians from ")


def test_without_two_cells_that_share_their_seeds_nothing_is_asked():
    seeds = choose(measurements({"seed": [0.0, 1.0]}, {"max_tracking_error": lambda seed: drawn(8, seed)}))
    assert find_answers(seeds) == []


def test_too_few_pairs_for_all_values_are_said_once_and_numbers_are_named_with_their_axis():
    given = {"max_tracking_error": lambda period: 1.0 + period + drawn(6, period) / 100.0}
    few = choose(measurements({"controller.period": [0.0, 1.0, 2.0, 3.0]}, given))
    assert sentences(find_answers(few)) == ["6 pairs are too few for 3 comparisons: at least 7 pairs are needed."]
    two = choose(measurements({"controller.period": [0.0, 1.0]}, given))
    assert "with controller.period=1 (" in sentences(find_answers(two))[0]
