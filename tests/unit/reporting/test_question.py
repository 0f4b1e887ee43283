"""First question and answer of a sweep, from sweeps whose differences are known."""

from dataclasses import replace

import numpy as np
import pytest
from support.sample_sweep import measurements, noisy

from runner.reporting.answer_map import MOST_CELLS, make_map
from runner.reporting.sentences import sentences, short_table
from runner.reporting.sweep.question import (
    asked_axis,
    causes,
    find_answers,
    in_short,
    made_equal,
    pairs_section,
    too_few,
)
from runner.reporting.sweep.report import _title as title_of
from runner.reporting.sweep.subject import choose
from runner.sweeps.differing import UnsweptDifference

AXES = {"noise.position": [1e-4, 1e-3], "controller": ["computed_torque", "operational_space"]}


def drawn(repetitions, *key):
    return np.random.default_rng([repetitions, *key]).normal(size=repetitions)


def sweep(error, repetitions=8, axes=AXES, **metrics):
    return choose(measurements(axes, {"max_tracking_error": error, **metrics}))


def turning(noise, law):
    """Errors whose order changes with the level of noise."""
    return 10.0 + (2.0 if noise == law else 0.0) + 0.1 * drawn(8, law, noise)


def agreeing(noise, law):
    return 10.0 + 5.0 * noise - 2.0 * law + 0.1 * drawn(8, law, noise)


def apart(noise, law):
    """Errors of one sign whose sizes differ by a factor of a hundred between the conditions."""
    return 100.0**noise * (10.0 - 2.0 * law + 0.1 * drawn(8, law, noise))


@pytest.mark.parametrize(
    ("axes", "asked"),
    [
        (["robot", "noise.position", "controller"], "controller"),
        (["robot", "trajectory", "controller.natural_frequency"], "controller.natural_frequency"),
        (["robot", "controller.period", "controller.damping_ratio"], "controller.damping_ratio"),
        (["plant", "controller.period", "trajectory"], "trajectory"),
        (["seed", "mismatch.spread", "torque_limits.max"], "torque_limits.max"),
        (["robot", "robot.payload.mass", "gravity", "plant.step", "environment", "seed", "noise"], None),
    ],
)
def test_the_law_is_asked_about_then_its_gains_then_other_choices_and_never_a_condition(axes, asked):
    numbers = {"controller.natural_frequency", "controller.period", "controller.damping_ratio", "seed", "gravity"}
    grid = {name: [1.0, 2.0] if name in numbers or "." in name else ["a", "b"] for name in axes}
    subject = sweep(lambda *_: drawn(8), axes=grid)
    found = asked_axis(subject)
    assert (found and found.name) == asked
    chosen = replace(subject, measurements=replace(subject.measurements, question=axes[0]))
    assert asked_axis(chosen).name == axes[0]  # as --by says


def test_a_sweep_over_conditions_names_no_winner():
    subject = sweep(agreeing, axes={"noise.position": [1e-4, 1e-3], "robot": ["panda", "ur5e"]})
    assert find_answers(subject) == []
    assert title_of(subject) == "What noise.position, robot changes"
    assert "smaller" not in in_short(subject)


def test_one_number_is_told_if_it_describes_all_conditions():
    subject = sweep(agreeing)
    first, agreement = sentences(find_answers(subject))
    assert first.startswith(
        "Largest tracking error: 16 % smaller with operational_space than with computed_torque (12."
    )
    assert agreement.startswith("By condition: operational_space is smaller in 2 of 2 conditions (")


@pytest.mark.parametrize("error", [turning, apart])
def test_no_pooled_number_is_told_if_conditions_contradict_or_are_far_apart(error):
    """E4: neither the sentence nor a table nor Python has it."""
    answers = find_answers(sweep(error))
    assert all(one.at for one in answers)
    head, *each = sentences(answers)
    assert [text.partition(":")[0] for text in each] == ["At noise.position=0.0001", "At noise.position=0.001"]
    if error is turning:
        assert head.startswith("Largest tracking error: the answer depends on the conditions: ")
    else:
        assert head == "Largest tracking error: operational_space is smaller in 2 of 2 conditions (19 to 21 %)."
    _, rows = short_table(answers)
    assert rows[0][1] == "2 conditions"
    assert all("all" not in row for row in rows)


def test_the_medians_of_a_law_may_differ_by_a_factor_of_three():
    for ratio, pooled in ((2.9, True), (3.1, False)):
        answers = find_answers(sweep(lambda noise, law, r=ratio: r**noise * (10.0 - law + 1e-3 * drawn(8, law, noise))))
        assert any(not one.at for one in answers) is pooled


def test_the_map_names_the_better_law_in_each_cell():
    axes = {"robot": ["panda", "ur5e"], **AXES}

    def error(robot, noise, law):
        return turning(noise, law) if robot else 10.0 + drawn(8, law, noise, 7)

    shown = make_map(find_answers(sweep(error, axes=axes)))
    assert (shown.corner, list(shown.columns)) == ("robot", ["noise.position=0.0001", "noise.position=0.001"])
    (_, panda), (_, ur5e) = shown.rows
    assert all(cell.text.startswith("not shown (") and cell.color is None for cell in panda)
    assert [(cell.text[:17], cell.color) for cell in ur5e] == [("operational_space", 1), ("computed_torque -", 0)]
    assert "8 pairs show no difference in" in shown.caption


def test_of_three_laws_a_winner_beats_both_others():
    axes = {"robot": ["panda", "ur5e"], "controller": ["a", "b", "c"]}
    answers = find_answers(
        sweep(lambda robot, law: 10.0 + (law == 2) + (robot and law == 1) + 0.01 * drawn(10, law), axes=axes)
    )
    (_, (panda,)), (_, (ur5e,)) = make_map(answers).rows
    assert panda.text == "a or b"
    assert ur5e.text.startswith("a -9")


def test_a_cell_at_a_limit_is_marked_and_its_torque_not_compared():
    def share(noise, law):
        return np.full(8, 0.2 if noise else 0.0)

    subject = sweep(
        agreeing, peak_torque=lambda noise, law: 50.0 + 10.0 * law + drawn(8, law), saturation_fraction=share,
        saturation_fraction_q2=share, peak_torque_q2=lambda *_: np.full(8, 87.0),
    )  # fmt: skip
    answers = find_answers(subject)
    assert [cell.text[-1] for _, (cell,) in make_map(answers).rows] == ["%", "*"]
    torque = [one for one in answers if one.metric == "peak_torque"]
    assert [one.word for one in torque] == ["larger", "at its limit"]  # pooled: at a limit as well, so left out
    assert torque[1].limit == "joint 2 is at its limit of 87 N m at up to 20 % of the ticks"


def test_of_very_many_conditions_those_that_differ_most_are_shown():
    axes = {"noise.position": list(np.linspace(1e-4, 1e-3, 200)), "controller": ["a", "b"]}
    answers = find_answers(
        sweep(lambda noise, law: 10.0 + law * noise / 50.0 + 1e-4 * drawn(16, law, noise), axes=axes)
    )
    shown = make_map(answers)
    assert len(shown.rows) == MOST_CELLS
    assert f"{MOST_CELLS} of 200 conditions are shown, those with the largest differences." in shown.caption
    assert [name for name, _ in shown.rows] == [f"noise.position={axes['noise.position'][place]:g}"
                                                for place in range(176, 200)]  # fmt: skip


def test_a_smaller_error_says_what_it_costs_in_the_same_sentence():
    def torque(noise, law):
        return 50.0 + 10.0 * law + 0.1 * drawn(8, law, noise)

    text = sentences(find_answers(sweep(agreeing, peak_torque=torque)))[0]
    assert "; its largest torque is larger by 10" in text
    assert text.endswith(" m.")  # the unit of the sample
    equal = sentences(find_answers(sweep(agreeing, peak_torque=lambda noise, law: 50.0 + noise + drawn(8, law))))[0]
    assert equal.endswith("; no difference in largest torque is shown.")


def test_the_end_of_a_sweep_tells_the_first_answer():
    assert in_short(sweep(agreeing)).startswith("Largest tracking error: 16 % smaller with operational_space than")


def test_what_differs_with_the_question_is_named():
    plain = sweep(agreeing)
    keys = ["a", "b", "c", "d"]
    found = [
        UnsweptDifference(key, ("controller",), [("computed_torque", "1"), ("operational_space", "2")]) for key in keys
    ]
    subject = replace(plain, measurements=replace(plain.measurements, differences=found))
    (text,) = causes(subject, find_answers(subject))
    assert text == "a, b, c and 1 more vary with controller and may be the cause: see Also differs."


def test_what_is_the_same_for_each_law_is_told():
    plain = sweep(agreeing)
    configs = [({"controller": {"natural_frequency": 20.0 + (cell == 1), "period": 0.01}, "trajectory": {"kind": "a"},
                 "plant": {"step": 1e-3}, "seed": 0}, np.array([cell])) for cell in range(4)]  # fmt: skip
    text = made_equal(replace(plain, measurements=replace(plain.measurements, configs=configs)))
    assert text.startswith("The same for each value of controller: period, plant step, path")
    assert text.endswith("; not the same: gains.")


def test_too_few_repetitions_say_what_they_cannot_show_and_name_no_cell():
    subject = sweep(lambda noise, law: drawn(5, law, noise))
    expected = "With 5 pairs no difference can be shown: 6 are the fewest, as by repetitions=6."
    assert too_few(subject) == expected
    assert expected in in_short(subject)
    assert "computed_torque" not in in_short(subject)
    assert too_few(sweep(lambda noise, law: drawn(6, law, noise))) == ""


def test_without_draws_there_is_no_talk_of_pairs():
    """T12: a sweep without noise asks for no repetitions; it has an exact answer."""
    for repetitions in (1, 6):
        sample = measurements(AXES, {"max_tracking_error": lambda noise, law, r=repetitions: np.full(r, 10.0 - law)})
        silent = [({"noise": {"position": 0.0, "distribution": "uniform"}, "mismatch": {"spread": 0.0}}, np.arange(4))]
        subject = choose(replace(sample, configs=silent))
        assert too_few(subject) == ""
        assert "10 % smaller with operational_space (9.0 m) than with computed_torque (10.0 m), exactly" in in_short(
            subject
        )
        assert "pair" not in " ".join(sentences(find_answers(subject)))


def test_what_too_few_pairs_cannot_answer_is_left_out_with_one_line():
    """E7: eight pairs can answer no seven comparisons."""
    axes = {"noise.position": [1e-4 * place for place in range(1, 8)], "controller": ["a", "b"]}
    answers = find_answers(sweep(lambda noise, law: 10.0 + law + 0.01 * drawn(8, law, noise), axes=axes))
    assert sentences(answers) == ["8 pairs are too few for 8 comparisons: 9 would do."]
    assert short_table(answers)[1] == [
        ["largest tracking error", "7 conditions", "", "", "too few pairs in 7 of 7 conditions"]
    ]
    (part,) = pairs_section(answers).sections
    assert [block.text for block in part.blocks] == ["8 comparisons have too few pairs (8): 9 would do."]


def test_comparisons_without_any_value_are_counted_and_have_no_row():
    axes = {"noise.position": [1e-4, 1e-3], "controller": ["a", "b"]}
    answers = find_answers(sweep(lambda noise, law: 10.0 + law + drawn(8, law) + (np.inf if noise else 0.0), axes=axes))
    (part,) = pairs_section(answers).sections
    table, text = part.blocks
    assert "no value in either" not in str(table.rows)
    assert text.text == "1 comparison has no value in either."


def test_of_several_values_the_first_six_are_told():
    laws = ["a", "b", "c", "d", "e", "f", "g", "h", "i"]
    subject = sweep(lambda law: 1.0 + law + drawn(20, law) / 100.0, axes={"controller": laws})
    lines = sentences(find_answers(subject))
    assert [text.split(" than with ")[1][0] for text in lines[:6]] == ["b", "c", "d", "e", "f", "g"]
    assert lines[6] == "2 more are in the tables."
    assert in_short(subject).startswith("largest tracking error: medians from ")


@pytest.mark.parametrize(
    ("failed", "said"),
    [
        ((), "largest tracking error: medians from 1 to 3 m."),
        ((2,), "largest tracking error: medians from 1 to 2 m; 1 of 3 cells has none."),
        ((1, 2), "largest tracking error: median 1 m; 2 of 3 cells have none."),
        ((0, 1, 2), ""),
    ],
)
def test_cells_without_a_median_are_counted_and_one_median_is_no_range(failed, said):
    metrics = {"max_tracking_error": lambda level: np.full(8, 1.0 + level)}
    assert in_short(choose(measurements({"noise.position": [1e-4, 1e-3, 1e-2]}, metrics, failed))) == said


def test_without_two_cells_that_share_their_seeds_nothing_is_asked():
    assert find_answers(sweep(lambda seed: drawn(8, seed), axes={"seed": [0.0, 1.0]})) == []


def test_numbers_are_named_with_their_axis():
    two = sweep(lambda period: 1.0 + period + drawn(6, period) / 100.0, axes={"controller.period": [0.0, 1.0]})
    assert "than with controller.period=1 (" in sentences(find_answers(two))[0]


def test_the_report_and_the_short_table_have_the_same_numbers():
    """T8: one estimator, one family and one rounding in sentence, short table and full table."""
    answers = find_answers(sweep(agreeing, peak_torque=noisy(lambda noise, law: 50.0 + law)))
    section = pairs_section(answers)
    full = {row[0]: row for row in section.sections[0].blocks[0].rows}
    for row in short_table(answers)[1]:
        if row[0] == "largest tracking error" and row[1] in full:
            assert row[3].startswith(f"{full[row[1]][2]} ({full[row[1]][3]})")
            assert full[row[1]][2].removeprefix("-") in sentences(answers)[0] or row[1] != "all"
