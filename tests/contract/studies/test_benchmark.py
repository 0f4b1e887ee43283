"""The benchmark of laws: who is ahead, from errors that are known, and its report from runs with such errors."""

import re
from argparse import Namespace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import spearmanr
from support.benchmark_runs import COLUMNS, SCATTER, SEEDS, SIZES, TUNINGS, benchmark_runs
from support.made_up_runs import planned
from support.recorded_runs import recorded
from support.study_plans import FULL_ALONE
from support.study_sections import texts

from runner.base import quantities
from runner.base.errors import RunnerError
from runner.papers.commands.reproduce import _chosen
from runner.papers.studies.benchmark import engines
from runner.papers.studies.benchmark.cells import cells
from runner.papers.studies.benchmark.figures import halves, said
from runner.papers.studies.benchmark.horizon import grown
from runner.papers.studies.benchmark.how_tuned import gains, keys_of, values_at_ends
from runner.papers.studies.benchmark.late_and_limited import bearable
from runner.papers.studies.benchmark.made import ARMS, CONDITIONS, turned
from runner.papers.study.chapters import Chapters
from runner.papers.study.check import never_failing
from runner.papers.study.measured import findings
from runner.papers.study.results import Results
from runner.papers.study.study import load_study
from runner.reporting.document import Table
from runner.reporting.mathml import faulty
from runner.reporting.words import in_words

STUDY = load_study("benchmark")
METRIC = "rms_tracking_error"
NAMES = "{question}/{arm}/{law}/{task}/{condition}/{gains}"


def a_run(errors, period=0.01):
    """Return a run as `cells` reads it: errors in m, NaN for a failed repetition, and its config."""
    config = {"controller": {"kind": "some", "period": period, "gain": np.random.default_rng().random()}, "seed": 0}
    return SimpleNamespace(
        metrics={"rms_tracking_error": {}}, values=lambda _: np.asarray(errors, dtype=float), config=config
    )


def cell(tunings=(1.0, 1.0, 1.0), **laws):
    """The cell of laws with errors along two paths, the second ten times as long, times a factor for each tuning."""
    runs = {
        f"first/arm/{law}/{task}/wind/{number}": a_run(factor * scale * np.asarray(errors, dtype=float))
        for law, errors in laws.items()
        for task, scale in (("line", 1.0), ("circle", 10.0))
        for number, factor in enumerate(tunings, start=1)
    }
    return cells(planned(NAMES, runs), "arm")["wind"]


def test_a_common_factor_is_found_whatever_the_seeds_have_in_common():
    made = cell(a=np.linspace(1.9, 2.1, SEEDS) * SCATTER, b=SCATTER, c=np.linspace(3.0, 3.1, SEEDS) * SCATTER)
    assert [each.law for each in made.entries] == ["b", "a", "c"]
    assert made.best.score == pytest.approx(np.sqrt(10.0) * np.median(SCATTER), rel=0.01)  # geometric mean of the paths
    lead = made.leads["b", "a"]
    assert lead.factor == pytest.approx(2.0, rel=0.02)
    assert 1.9 < lead.interval[0] < 2.0 < lead.interval[1] < 2.1
    assert lead.p_value == pytest.approx(3.0 * 2.0 / 2.0**SEEDS)  # all pairs agree; of three, Holm's first times three
    assert made.groups == [["b"], ["a"], ["c"]]


def test_what_the_seeds_do_not_bear_out_is_a_tie_and_so_is_less_than_a_hundredth():
    turned = SCATTER * np.where(np.arange(SEEDS) % 2, 1.3, 0.8)
    made = cell(a=SCATTER, b=turned, c=1.005 * SCATTER)
    assert made.leads["a", "c"].p_value < 0.05
    assert [sorted(own) for own in made.groups] == [["a", "b", "c"]]


def test_a_lead_that_one_tuning_turns_round_is_a_tie():
    laws = {"a": 1.3 * SCATTER, "b": SCATTER}
    assert cell(tunings=(1.0, 1.05, 0.95), **laws).leads["b", "a"].shown
    apart = cell(tunings=(1.0, 1.2, 0.9), **laws).leads["b", "a"]  # the worst of b, 1.2, and the best of a, 1.17
    assert not apart.shown
    assert apart.interval[0] == pytest.approx(0.9 * 1.3 / 1.2, rel=0.05)
    assert apart.interval[1] == pytest.approx(1.2 * 1.3 / 0.9, rel=0.05)
    assert apart.factor == pytest.approx(1.3)


def test_a_law_stands_in_the_group_after_the_last_one_that_is_ahead_of_it():
    wide = SCATTER * np.where(np.arange(SEEDS) % 2, 1.4, 0.75)  # neither ahead of a nor behind b; a is ahead of b
    made = cell(a=SCATTER, b=1.2 * SCATTER, c=wide, d=2.0 * SCATTER)
    assert made.leads["a", "b"].shown
    assert [sorted(own) for own in made.groups] == [["a", "c"], ["b"], ["d"]]


def repeating(condition="all", **by_round):
    """Runs of laws whose errors in rounds 4, 8 and 16 are given, along one path and for two tunings."""
    made = {}
    for law, errors in by_round.items():
        for number in (1, 2):
            one = a_run(SCATTER)
            own = {f"{METRIC}_period_{after}": error for after, error in zip((4, 8, 16), errors, strict=True)}
            one.metrics, one.values = own, lambda name, own=own: own[name] * SCATTER
            made[f"learned/macro/{law}/line/{condition}/{number}"] = one
            made[f"first/macro/{law}/line/{condition}/{number}"] = a_run(SCATTER)
    return planned(NAMES, made)


@pytest.mark.parametrize(
    ("rounds", "told"),
    [
        ({"a": (1, 1, 1), "b": (1.5, 1.2, 1.1)}, ""),
        ({"a": (1, 1, 1), "b": (1.5, 1.2, 0.9)}, "b passes a by round 16"),
        ({"a": (1, 1, 1), "b": (1.5, 0.9, 1.5)}, "b passes a by round 8"),
        ({"a": (1, 1, 1), "b": (1.01, 0.9, 0.9)}, ""),  # a was not ahead by 2 %
        ({"a": (1, 1, 1), "b": (1.5, 0.99, 0.99)}, ""),  # nor is b later
        ({"a": (1, 1, 1), "b": (2, 2, 2), "c": (3, 3, 3), "d": (4, 4, 2.5)}, "d passes c by round 16"),
        ({"a": (1, 1, 1), "b": (2, 2, 2), "c": (3, 3, 3), "d": (4, 4, 4), "e": (5, 5, 3.5)}, ""),  # behind the third
    ],
)
def test_a_later_round_that_changes_the_order_of_the_first_three_is_told(rounds, told):
    runs = repeating(**rounds)
    assert turned(runs, "macro", "all") == told
    answered = said(runs, "macro", "learned", "all")
    assert answered.startswith("no answer: in round 4 ") == bool(told)
    assert answered.endswith(told)
    assert ("ahead" in answered) == (not told and rounds["b"][0] > 1.02)


@pytest.mark.parametrize(("last", "grown_by"), [(0.9, 0.9), (1.3, 1.3)])
def test_growth_is_that_of_the_law_that_grows_most(last, grown_by):
    runs = repeating(a=(1.0, 1.0, 1.0), b=(2.0, 2.0, 2.0 * last))
    assert grown(runs, "all").value == pytest.approx(max(1.0, grown_by))
    assert grown(runs, "all", "b").value == pytest.approx(grown_by)


def test_a_failed_repetition_is_an_error_beyond_every_number():
    fallen = np.where(np.arange(SEEDS) < SEEDS // 4, np.nan, 0.9 * SCATTER)
    made = cell(a=SCATTER, b=np.full(SEEDS, np.nan), c=fallen)
    assert [each.law for each in made.entries][-1] == "b"
    assert [made.entry(law).failed for law in "abc"] == [0.0, 1.0, 0.25]
    assert made.entry("b").score == np.inf
    assert made.leads[made.best.law, "b"].shown
    assert not made.leads["a", "c"].shown  # better in only a quarter


@pytest.mark.parametrize("repetitions", [1, SEEDS])
def test_where_nothing_is_drawn_a_lead_holds_along_every_path(repetitions):
    runs = {
        f"first/arm/{law}/{task}/wind/{number}": a_run([error] * repetitions)
        for law, errors in {"a": (1.0, 5.0), "b": (2.0, 4.0), "c": (1.1, 5.5)}.items()
        for task, error in zip(("line", "circle"), errors, strict=True)
        for number in (1, 2, 3)
    }
    made = cells(planned(NAMES, runs), "arm")["wind"]
    assert made.best.law == "a"
    assert (made.leads["a", "c"].shown, made.leads["a", "b"].shown) == (True, False)
    assert (made.leads["a", "c"].interval, made.leads["a", "c"].p_value) == (None, None)


def test_another_gain_is_compared_and_another_period_is_refused():
    alike = {f"first/arm/{law}/line/wind/{number}": a_run(SCATTER) for law in "ab" for number in (1, 2, 3)}
    assert list(cells(planned(NAMES, alike), "arm")) == ["wind"]
    with pytest.raises(RunnerError, match=r"line, wind: controller.period is 0.01 for a and 0.005 for b; "):
        cells(planned(NAMES, alike | {"first/arm/b/line/wind/2": a_run(SCATTER, period=0.005)}), "arm")


def test_halves_of_the_seeds_are_held_against_each_other():
    even = np.arange(SEEDS) % 2 == 0
    turned = {
        f"first/macro/{law}/line/all/{gains}": a_run(errors)
        for law, errors in {"a": np.where(even, 1.0, 2.0) * SCATTER, "b": np.where(even, 2.0, 1.0) * SCATTER}.items()
        for gains in TUNINGS
    }
    found = [cells(planned(NAMES, turned), "macro", seeds=slice(start, None, 2))["all"] for start in (0, 1)]
    assert [half.best.law for half in found] == ["a", "b"]
    assert [half.best.errors.shape for half in found] == [(2, 1, SEEDS // 2)] * 2
    assert halves(planned(NAMES, turned)) == (2, 0, 2)
    alike = {name: a_run((1.0 if "/a/" in name else 2.0) * SCATTER) for name in turned}
    assert halves(planned(NAMES, alike)) == (2, 2, 0)
    half = {name: a_run(np.where(even, 1.0, 2.0) * SCATTER if "/a/" in name else 2.0 * SCATTER) for name in turned}
    assert halves(planned(NAMES, half)) == (1, 0, 0)


def test_values_near_an_end_of_their_range_are_named_with_law_and_arm():
    """Within 2 % of the ends of 0.3 to 30, on the logarithmic scale, lies what is below 0.33 or above 27."""
    values = {"untuned": (3.0, 3.0), "1": (0.32, 0.34), "2": (28.0, 3.0)}  # of both questions
    runs = {
        f"{question}/macro/spring/line/exact/{gains}": SimpleNamespace(
            config={"controller": {"kind": "spring", "gain": own[place]}}, record={"command": "runner"}
        )
        for gains, own in values.items()
        for place, question in enumerate(("first", "learned"))
    }
    ranges = {f"{question}/macro/spring": {"controller.gain": [0.1, 10.0]} for question in ("first", "learned")}
    told = [row[2:] for row in values_at_ends(planned(NAMES, runs), ranges)]
    assert told == [
        ["from the first second", "1", "controller.gain", "0.32", "lower end"],
        ["from the first second", "2", "controller.gain", "28", "upper end"],
        ["once learned", "2", "controller.gain", "as before", "gains of the bandwidth"],
    ]


@pytest.fixture(scope="module")
def whole():
    """The plan of the full profile."""
    return load_study("benchmark", profile="full").jobs()


@pytest.fixture
def runs(made):
    """Every run of the plan."""
    return made("benchmark").runs


def test_it_is_not_made_with_all_studies():
    assert "benchmark" not in {
        study.name for study in _chosen(Namespace(study="all", code=False, profile="", parts=())) if study is not None
    }


@pytest.mark.costs(3)
def test_all_findings_hold_of_such_errors(made):
    document = made("benchmark").document
    told = [finding for _, finding in findings(document)]
    assert [each.title for each in told if not each.holds] == []
    assert len(told) == 9
    assert list(faulty(document)) == []


def test_the_page_names_the_best_law_and_how_far_it_is_ahead(made):
    words = " | ".join(texts(made("benchmark").chapters.section("which_law.md")))
    best = "computed torque + observer, 1.75 times ahead of adaptive"
    passed = "no answer: in round 4 computed torque + observer; adaptive passes computed torque + observer by round 8"
    assert f"unknown friction | {best} | {best} | {best} | {best}" in words
    assert f"unknown friction | {best} | {best} | {passed} | {passed}" in words  # once learned
    tied = "operational space; tied with computed torque"
    assert f"nothing is wrong | {tied} | {tied} | {tied} | {tied}" in words


def test_every_arm_and_law_of_ours_has_its_section_and_words(made, whole):
    arms, tuning = (made("benchmark").chapters.section(file) for file in ("by_arm.md", "how_tuned.md"))
    assert [each.title for each in arms.sections] == ["Macro", "Planar arm", "xArm7", "Panda"]
    laws = next(block for block in tuning.blocks if isinstance(block, Table))
    assert [row[0] for row in laws.rows] == [*map(in_words, SIZES), "iterative learning"]
    assert not {"A law from outside.", "not known here"} & set(texts(tuning))
    assert all(row[-1].endswith(" ms") for row in laws.rows[:-1])
    assert {name.split("/")[2] for name in whole if name.startswith("first/")} == set(SIZES)
    assert {name.split("/")[1] for name in whole if name.startswith("first/")} == set(ARMS)
    assert {name.split("/")[4] for name in whole if name.startswith("first/")} == set(CONDITIONS)


def test_gains_of_every_tuning_are_listed_where_they_differ(runs):
    table = gains(runs, "Gains.")
    assert [column if isinstance(column, str) else column.title for column in table.header][3:] == [
        "not tuned", "first, 1", "first, 2", "learned, 1", "learned, 2"
    ]  # fmt: skip
    for arm, law, key, *own in table.rows:
        level = next(name for name in SIZES if in_words(name) == law)
        place = next(name for name in ARMS if ARMS[name] == arm)
        assert own[0] == quantities.number(float(keys_of(runs, place, level, "first", "untuned")[key]))


def test_a_delay_of_one_tick_bears_the_root_of_its_cubic():
    assert bearable(0).value == pytest.approx(1.0, abs=1e-9)
    a = bearable(1).value
    assert a**3 - 8.0 * a**2 + 22.0 * a - 8.0 == pytest.approx(0.0, abs=1e-9)
    assert bearable(2).value == pytest.approx(0.2579, abs=1e-4)


def test_the_orders_on_two_plants_are_held_against_each_other(runs):
    assert (engines.mean_correlation(runs).value, engines.against(runs).value) == (1.0, 0.0)
    of = {"joint_pd": "passivity", "passivity": "joint_pd"}
    swapped = {
        name: runs["/".join([plan, arm, of.get(law, law), *rest])] if plan == "engine" else one
        for name, one in runs.items()
        for plan, arm, law, *rest in [name.split("/")]
    }
    assert engines.against(STUDY.results(swapped)).value >= 5.0  # joint PD far behind, far ahead, under each condition
    sizes, others = (np.array([SIZES[law] for law in laws]).T for laws in (SIZES, [of.get(law, law) for law in SIZES]))
    judged = [COLUMNS.index(condition) for condition in ("exact", "masses", "friction", "encoders", "all")]
    expected = [spearmanr(sizes[column], others[column]).statistic for column in judged]
    assert engines.mean_correlation(STUDY.results(swapped)).value == pytest.approx(np.mean(expected), abs=0.02)


@pytest.mark.parametrize("file", FULL_ALONE)
def test_what_the_full_profile_alone_shows(tmp_path, whole, file):
    arms, condition, count = {
        "late_and_limited.md": ("macro|mini", "(exact|limits_.*|delay_2)", 3),
        "halves.md": ("macro", "masses", 1),
    }[file]
    wanted = re.compile(rf"first/({arms})/\w+/circle/{condition}/.*")
    names = [name for name in whole if wanted.fullmatch(name)]
    chapters = Chapters(STUDY, STUDY.results(benchmark_runs(names, recorded("benchmark", tmp_path))), Results({}))
    told = [finding for _, finding in findings(SimpleNamespace(sections=[chapters.section(file)]))]
    assert [each.title for each in told if not each.holds] == []
    assert len(told) == count
    assert never_failing(file, chapters.reading(file.removesuffix(".md"))) == []
