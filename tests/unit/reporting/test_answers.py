"""Verdicts on a comparison: each word against given pairs, and its agreement with interval and p."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from runner.base.quantities import ROUNDING, share_of_larger
from runner.reporting.answers import PAIRS, judge
from runner.reporting.asked import AskedComparison
from runner.reporting.conditions import conditions_of, describes
from runner.statistics import compare_paired
from runner.statistics.conclusion import ALPHA
from tools.answers import CASES, false_answers, same_law, true_answers

N = 8
APART = np.linspace(0.9, 1.1, N)  # differences of one sign


def asked(differences, metric="rms_tracking_error", size=1.0, unit="m", error=None, rounding=0.0):
    a = np.full(len(differences), size)
    return AskedComparison(metric, unit, replace(compare_paired(a, a + differences), error=error, rounding=rounding))


def one(*given, **more):
    (answer,) = judge([asked(*given, **more)], ["rms_tracking_error"])
    return answer


@pytest.mark.parametrize(("sign", "word"), [(1.0, "larger"), (-1.0, "smaller")])
def test_a_difference_that_is_shown_and_matters_is_said(sign, word):
    answer = one(sign * 0.5 * APART)
    assert (answer.word, answer.sign, answer.p_value) == (word, sign, 2.0**-7)


@pytest.mark.parametrize("size", [1e-5, 1.0, 1e4])
def test_up_to_two_per_cent_of_the_larger_median_is_no_answer(size):
    almost, more = (size * share / (1.0 - share) * (1.0 + 1e-6 * APART) for share in (0.019999, 0.020001))
    assert one(almost, size=size).word == "less than 2 % apart"
    assert one(more, size=size).word == "larger"
    assert one(-0.020001 * size * (1.0 + 1e-6 * APART), size=size).word == "smaller"


def test_of_a_fraction_it_is_two_hundredths():
    values = {"metric": "saturation_fraction", "unit": "1", "size": 0.001}
    assert one(0.0199 * (1 + 1e-6 * APART), **values).word == "less than 0.02 apart"
    assert one(0.0201 * (1 + 1e-6 * APART), **values).word == "larger"


def test_what_the_plants_step_leaves_is_no_answer_and_is_told():
    assert one(0.5 * APART, error=0.6).word == "below what the plant's step leaves (0.6 m)"
    assert one(0.5 * APART, error=0.4).word == "larger"
    assert one(0.5 * APART, error=np.inf).word == "below what the plant's step leaves (a run fails on a finer step)"
    assert "integration error unknown" in one(0.5 * APART).sentence()
    assert "unknown" not in one(0.5 * APART, error=0.4).sentence()


def test_pairs_that_are_equal_up_to_rounding_say_so():
    (answer,) = judge([asked(1e-14 * np.arange(-4.0, 4.0))], [])
    assert answer.sentence() == "Rms tracking error: A (1.00 m) and B are equal up to rounding (8 pairs)."
    assert answer.short_cells == ["1.00 m", "0", "equal up to rounding"]
    assert answer.word == "equal up to rounding"
    assert not one(1e-3 * APART).equal


def test_pairs_within_what_rounding_changes_are_equal_up_to_rounding():
    both_ways = 0.0999 * np.array([-1.0, 1.0] * 4)
    answer = one(both_ways, rounding=0.1)
    assert answer.sentence() == (
        "Rms tracking error: A (1.000 m) and B are equal up to rounding, which changes it by 10 % (8 pairs)."
    )
    assert answer.short_cells[2] == "equal up to rounding, which changes it by 10 %"
    assert not one(both_ways, rounding=0.09).equal
    assert not one(both_ways).equal
    few = one(0.05 * APART[:1], rounding=0.1)
    assert few.equal
    assert few.short_cells[1] == "+0.045 m"  # the difference itself, which is not small


def test_a_difference_of_one_sign_is_more_than_rounding():
    """Rounding changes draws in both directions, so that the test of the signs stays valid."""
    answer = one(0.1 * APART, rounding=0.2)
    assert (answer.word, answer.within_rounding, answer.equal) == ("larger", True, False)


def test_rounding_of_nothing_is_no_answer():
    assert one(0.9 * ROUNDING * np.ones(N), size=0.0).word == "equal up to rounding"
    assert one(1.1 * ROUNDING * np.ones(N), size=0.0).word == "larger"


def test_fewer_than_six_pairs_say_what_they_cannot_show():
    answer = one(APART[:5])
    assert answer.word == "too few pairs to say (5 of 6)"
    assert answer.sentence().endswith("At least 6 pairs are needed.")
    assert (answer.p_value, answer.interval, answer.sign) == (None, None, 0)


def test_too_few_pairs_for_so_many_comparisons_say_how_many_would_do():
    few = judge([asked(APART)] * 7, ["rms_tracking_error"])  # .0078 times 7 is above .05, times 6 below
    assert {answer.word for answer in few} == {"too few pairs for 7 comparisons (8 of 9)"}
    assert few[0].sentence().endswith("At least 9 pairs are needed.")
    enough = judge([asked(APART)] * 6, ["rms_tracking_error"])
    assert {answer.word for answer in enough} == {"larger"}


def test_pairs_that_show_nothing_say_what_they_can_show_and_how_many_would_do():
    rng = np.random.default_rng(1)
    a = rng.normal(10.0, 1.0, 20)
    (answer,) = judge([AskedComparison("rms_tracking_error", "m", compare_paired(a, a + rng.normal(0.0, 1.0, 20)))], [])
    text, found = answer.sentence(), answer.comparison
    assert text.startswith("Rms tracking error: no difference is shown between A (")
    best = found.smallest_shown(ALPHA)
    share = 100.0 * best / max(found.medians)
    assert f"20 pairs can show {share:.2g} % ({best:.2g} m) at best" in text
    assert "p = " not in text
    count = found.pairs_needed(0.05 * max(found.medians), ALPHA)
    assert f"; {count} would show 5 % (" in text


def test_an_answer_tells_the_larger_value_the_share_and_the_interval():
    """T14 of the review: p and its level stand once on a page, not in each sentence."""
    answer = one(-0.5 * APART)
    assert answer.sentence() == (
        "Rms tracking error: 50 % smaller with B than with A (1.00 m): by 0.50 m in pairs (0.46 to 0.54 m, 8 pairs, "
        "integration error unknown)."
    )
    assert answer.short_cells == ["1.00 m", "-0.50 m (-0.54 to -0.46 m)", "B 50 % smaller"]
    assert one(0.5 * APART).short_cells[2] == "A 33 % smaller"
    assert "At most 5 % of metrics without a difference get an answer" in PAIRS


@pytest.mark.parametrize("seed", range(12))
def test_the_printed_difference_and_value_give_the_true_per_cent(seed):
    """T10: "22 % smaller with 0.7 than with 0.85, by 0.19" must not be printed."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-6, 3)
    differences = size * rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.8) * (1.0 + 0.2 * rng.random(N))
    answer = one(differences, size=size, error=0.0)
    found = re.search(r"([\d.]+) % smaller .* \(([\d.]+) (\S+)\): by ([\d.]+) (\S+) in pairs", answer.sentence())
    share, larger, unit, difference, other = found.groups()
    assert unit == other
    assert float(share) == float(f"{100.0 * float(difference) / float(larger):.2g}")
    found = answer.comparison
    assert float(share) == float(f"{100.0 * abs(found.difference) / max(found.medians):.2g}")


def test_a_hundred_per_cent_is_said_of_zero_alone_and_never_more():
    assert share_of_larger(0.97, 0.03, 1.0) == "97 %"
    assert share_of_larger(0.9999, 1e-4, 1.0) == "99.9 %"
    assert share_of_larger(1.0, 0.0, 1.0) == "100 %"
    assert share_of_larger(1.04, 0.1, 1.0) == share_of_larger(0.5, -0.2, 0.3) == share_of_larger(1.0, 1.0, np.inf) == ""


def test_what_draws_nothing_is_exact():
    """T12: no talk of pairs where nothing is drawn, and the sentence has the plant's own error."""

    def exact(difference, error):
        found = replace(compare_paired(np.ones(1), np.ones(1) + difference), error=error, exact=True)
        return judge([AskedComparison("rms_tracking_error", "m", found)], ["rms_tracking_error"])[0]

    answer = exact(-0.3, 0.01)
    assert answer.sentence() == (
        "Rms tracking error: 30 % smaller with B (0.70 m) than with A (1.00 m), exactly: nothing is drawn, integration "
        "error 0.01 m."
    )
    assert (answer.p_value, answer.interval, answer.sign) == (None, None, -1)
    assert answer.short_cells[2] == "B 30 % smaller, exactly"
    below = exact(-0.3, 0.31)
    assert (below.sign, below.word) == (0, "below what the plant's step leaves (0.31 m)")
    assert "pair" not in below.sentence() + answer.sentence()
    assert exact(-0.019, 0.001).word == "less than 2 % apart"
    assert "integration error unknown" in exact(-0.3, None).sentence()


def test_a_torque_at_its_limit_is_no_result():
    """T13: neither "larger" nor "equal" is said of a metric that shows a limit; it is in no family."""
    limited = replace(asked(APART, "peak_torque"), limit="joint 2 is at its limit of 87 N m")
    first, second = judge([limited, asked(APART, "peak_torque")], ["peak_torque"])
    assert (first.sign, first.word, first.p_value, first.equal) == (0, "at its limit", None, False)
    assert first.sentence() == "Largest torque: A and B are not compared: joint 2 is at its limit of 87 N m."
    assert first.short_cells[1:] == ["–", "not compared: joint 2 is at its limit of 87 N m"]
    assert (second.family, second.p_value) == (1, 2.0**-7)


def test_no_power_below_what_counts_is_promised():
    """T11: 8 pairs cannot show 1.2 % where a difference counts from 2 % on."""
    close = 1e-4 * np.array([1.0, -1.0, 2.0, -2.0, 1.0, -1.0, 2.0, -2.0])
    text = one(close, error=0.0).sentence()
    assert "8 pairs can show 2 % (0.02 m) at best." in text


def test_a_metric_without_a_value_in_some_draws_says_in_how_many():
    a, b = np.ones(N), np.where(np.arange(N) < 3, np.inf, 1.5)
    (answer,) = judge([AskedComparison("settling_time", "s", compare_paired(a, b))], [])
    assert "no value in 0 and 3 of 8 draws" in answer.sentence()


def test_pairs_without_a_number_promise_nothing_and_have_no_end():
    """One draw of eight in which one side fails the other way: no difference can be shown with 80 %."""
    a, b = np.where(np.arange(N) == 0, np.inf, 1.0), np.where(np.arange(N) > 4, np.inf, 1.01)
    (answer,) = judge([AskedComparison("settling_time", "s", compare_paired(a, b))], [])
    text = answer.sentence()
    assert "(unbounded, 8 pairs, no value in 1 and 3 of 8 draws)" in text
    assert "can show" not in text
    assert answer.pairs_that_tell is None
    (beyond,) = judge([AskedComparison("settling_time", "s", compare_paired(np.ones(N), np.full(N, np.inf)))], [])
    assert "by more than any number in pairs (beyond every number, 8 pairs" in beyond.sentence()


def test_as_many_pairs_are_said_to_do_as_are_needed_in_so_many_comparisons():
    nothing = asked(APART[:7] * np.array([1, -1, 1, -1, 1, -1, 1]))
    answers = judge([nothing] * 8, ["rms_tracking_error"])  # 8 times 2 / 2^8 is above .05
    assert {answer.fewest for answer in answers} == {9}
    (condition,) = conditions_of([replace_at(answers[0])], "rms_tracking_error")
    assert condition.word == "too few pairs (9 would do)"


def test_conditions_without_draws_are_only_called_equal_if_they_are():
    close = replace(compare_paired(np.ones(1), np.ones(1) + 0.005), error=0.0, exact=True)
    (answer,) = judge([AskedComparison("rms_tracking_error", "m", close)], [])
    (condition,) = conditions_of([replace_at(answer)], "rms_tracking_error")
    assert condition.word == "less than 2 % apart, exact"


def test_a_pooled_answer_without_a_sign_does_not_describe_a_condition_with_one():
    none, larger = judge([asked(0.001 * APART)], [])[0], judge([asked(0.5 * APART)], [])[0]
    assert describes(none, [none, none])
    assert describes(larger, [none, larger])
    assert not describes(none, [none, larger])


def replace_at(answer):
    return replace(answer, pairs=SimpleNamespace(at={"robot": "macro"}, first="A", second="B", axis=""))


def test_the_comparisons_of_a_metric_are_one_family_whatever_else_is_asked():
    """T8: the same comparison has the same p in a short table, in all metrics and in a report."""
    names = ["rms_tracking_error", *["peak_torque"] * 4, *["energy"] * 2]
    found = judge([asked(APART, metric=name) for name in names], ["rms_tracking_error", "peak_torque"])
    assert [answer.family for answer in found] == [1, 4, 4, 4, 4, 2, 2]
    assert [answer.p_value * 128 for answer in found] == [1, 4, 4, 4, 4, 2, 2]
    assert [answer.rank for answer in found] == [0, 1, 1, 1, 1, 2, 2]
    single = judge([asked(APART, metric="energy")] * 2, ["energy"])
    assert [answer.cells for answer in single] == [answer.cells for answer in found[-2:]]


def test_all_comparisons_of_a_metric_have_one_unit():
    found = judge([asked(size * APART, size=size) for size in (4e-5, 8e-3)], [])
    assert {answer.printed.values[0].partition(" ")[2] for answer in found} == {"mm"}


def test_word_interval_and_p_never_contradict():
    said = 0
    for seed in range(400):
        rng = np.random.default_rng(seed)
        family = [asked((rng.standard_t(2, 10) + rng.choice([0.0, 2.0])).round(seed % 3)) for _ in range(5)]
        for answer in judge(family, ["rms_tracking_error"]):
            low, high = answer.interval or (-np.inf, np.inf)
            assert (answer.p_value < ALPHA) == (low > 0.0 or high < 0.0)
            assert answer.sign in (0, np.sign(low) if low > 0.0 else -1 if high < 0.0 else 0)
            assert (answer.word == "no difference shown") <= (answer.p_value >= ALPHA)
            said += answer.sign != 0
    assert said > 100


@pytest.mark.parametrize("case", CASES)
def test_of_sweeps_of_equal_laws_few_say_a_winner(case):
    assert max(false_answers(CASES[case], 300)) <= 0.06 + 3.0 * np.sqrt(0.06 * 0.94 / 300)


def test_one_law_in_another_floating_point_order_is_never_smaller():
    assert same_law(40) == 0


def test_a_difference_of_the_size_of_its_scatter_is_said():
    assert true_answers(100) >= 0.9


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_of_two_thousand_sweeps_of_equal_laws_a_winner_is_said_in_six_per_cent_at_most(case):
    assert max(false_answers(CASES[case], 2000)) <= 0.06


@pytest.mark.slow
def test_of_a_thousand_no_law_beats_itself_and_what_is_there_is_found():
    assert same_law(1000) == 0
    assert true_answers(2000) >= 0.95
