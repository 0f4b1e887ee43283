"""`runner reproduce STUDY --challenge`: written conditions asked anew, with the thesis' old wordings as cases."""

import pytest

from runner.base.errors import RunnerError
from runner.papers.study import challenge
from runner.papers.study.asked import check_chosen
from runner.papers.study.chapters import Chapters
from runner.papers.study.execute import make_all
from runner.papers.study.items import Way
from runner.papers.study.measured import Measured
from runner.papers.study.report import study_document
from runner.papers.study.study import load_study

ABOUT = "title: T\nsource: S\nabstract: A\nchapters: [one.md]\n"
TRACKING = """\
grids:
  tracking:
    name: "{{ figure }}"
    with: ["experiment=thesis/{{ figure }}", preset=full_equations, plant=rk4, repetitions=1]
    over: {figure: [figure_5_12, macro_alone]}
"""
BETTER = """\
# Was the thesis right?

{% set one = metric("figure_5_12", "max_axis_error", "tracking error of the pair") %}
{% set macro = metric("macro_alone", "macro_max_axis_error", "tracking error of the Macro") %}

::: stands A Mini on top tracks {{ macro / one }} times better than the Macro.
holds: one < 0.02 * macro
:::
"""
GOAL = """\
grids:
  goal:
    name: "{{ figure }}"
    with: ["experiment=thesis/{{ figure }}", preset=full_equations, plant=bullet, repetitions=1, duration=2]
    over: {figure: [figure_5_8, macro_alone_goal]}
  other:
    name: figure_5_8/rk4
    with: [experiment=thesis/figure_5_8, preset=full_equations, plant=rk4, repetitions=1, duration=2]
"""
SOONER = """\
# Was the thesis right?

{% set goal = metric("figure_5_8", "settling_time", "settling time of the pair") %}
{% set goal_alone = metric("macro_alone_goal", "macro_settling_time", "settling time of the Macro alone") %}
{% set other_engine = metric("figure_5_8/rk4", "settling_time", "settling time of the pair, Runge-Kutta") %}

::: falls It does not reach a goal sooner.
The engine decides by how much: on Runge-Kutta the pair takes {{ other_engine }}.
holds: goal > 0.95 * goal_alone
holds: other_engine < 0.95 * goal
:::
"""


@pytest.fixture(name="study")
def _study(tmp_path, monkeypatch):
    """Write and make a study, and ask its findings anew under some values of the families."""

    def made(runs, chapter, values, chosen=""):
        folder = tmp_path / "paper"
        folder.mkdir()
        for name, text in {"study.yaml": ABOUT, "runs.yaml": runs, "one.md": chapter}.items():
            (folder / name).write_text(text)
        monkeypatch.setattr(challenge, "read_values", lambda _: values)
        study = load_study(str(folder))
        way = Way(tmp_path / "outputs", ["hydra.sweeper.workers=0"], "runner reproduce", study.config_dirs)
        chapters = Chapters(study, *make_all(study, way.outputs, way.overrides))
        document = study_document(chapters)
        return challenge.challenge_study(chapters, document, way, chosen)

    return made


@pytest.mark.costs(4)
def test_the_old_ratio_of_the_thesis_is_turned_by_other_goals_and_a_slower_motion(study):
    (found,) = study(TRACKING, BETTER, {"goal": [2], "duration": [2], "noise": [0.333]})
    answers = {each.label: each.answer for each in found.outcomes}
    goal = next(label for label in answers if label.startswith("the goal"))
    assert answers == {"fresh seeds": "holds", goal: "turns", "a motion of 6 s": "turns", "noise times 0.333": "holds"}
    why = next(each.why for each in found.outcomes if each.label == goal)
    assert why.startswith("tracking error of the pair < 0.02 times tracking error of the Macro: ")


@pytest.mark.costs(5)
def test_the_old_sentence_on_the_goal_is_turned_by_one_engine_for_both_sides(study):
    (found,) = study(GOAL, SOONER, {"engine": ["bullet", "rk4"]})
    answers = {each.label: each.answer for each in found.outcomes}
    assert answers["fresh seeds"] == "holds"
    assert answers["the engine rk4"] == "turns"
    assert answers.get("the engine bullet") == "turns", found.left_out  # the same run there


STUCK = """\
# One

{% set goal = metric("figure_5_8", "settling_time", "settling time of the pair") %}
{% set macro = metric("macro_alone_goal", "macro_settling_time", "settling time of a Macro") %}

::: stands The pair needs less than twice the time of a Macro.
holds: goal < 2 * macro
:::
"""


@pytest.mark.costs(4)
def test_neither_side_works_where_friction_holds_both(study):
    (found,) = study(GOAL.split("  other:")[0], STUCK, {"friction": [5.0]})
    answers = {each.family: each for each in found.outcomes}
    assert answers["seeds"].answer == "holds"
    assert answers["friction"].answer == "cannot be asked"
    assert "settling time of the pair: has no value" in answers["friction"].why


ENGINES = {
    "study.yaml": ABOUT,
    "runs.yaml": """\
grids:
  goal:
    with: [robot=macro, trajectory=quintic, duration=0.1, plant.step=0.001]
    over: {plant: [bullet, rk4]}
""",
    "one.md": """\
# One

{% set first = metric("goal/bullet", "max_tracking_error", "error on the first engine") %}
{% set other = metric("goal/rk4", "max_tracking_error", "error on Runge-Kutta") %}
{% set apart = largest("difference of the engines", first - other, other - first) %}

::: finding The engines differ
holds: apart > 1e-7 * other
Their errors are not equal.
:::

## Two

::: finding The engines differ, which is what it says
about: engine
holds: apart > 1e-7 * other
Their errors are not equal.
:::
""",
}
"""A study of one motion on two engines, without noise; the first finding says nothing of engines in its marks."""


@pytest.fixture(name="engines")
def _engines(tmp_path, monkeypatch):
    folder = tmp_path / "two_engines"
    folder.mkdir()
    for name, text in ENGINES.items():
        (folder / name).write_text(text)
    monkeypatch.setattr(challenge, "read_values", lambda _: {"engine": ["bullet", "rk4"], "step": [0.2]})
    return folder


HERE = "hydra.sweeper.workers=0"


@pytest.mark.costs(6)
def test_a_finding_that_an_engine_turns_is_printed_and_a_problem_of_the_check(cli, engines):
    ending = cli("reproduce", "two_engines", "--check", "--challenge", HERE)
    assert ending.code == 1
    header, first, second, *_ = ending.out.splitlines()
    assert header.split("  ")[0] == "section"
    assert [cell.strip() for cell in first.split("  ") if cell.strip()] == [
        "1", "The engines differ", "fresh seeds, a finer step", "other engines",
    ]  # fmt: skip
    assert second.split()[0] == "1.1"
    assert "other engines" not in second
    assert "section 1: turns with the engine rk4: difference of the engines > " in ending.out
    said = "section 1: The engines differ: not settled numerically: turned by the engine bullet, the engine rk4"
    assert said in ending.err
    again = cli("reproduce", "two_engines", "--check", "--challenge", "1.1", HERE)
    assert again.code == 0  # only the second finding, which is about the engine
    page = (engines.parent / "outputs/reports/two_engines/report.html").read_text()
    assert "Scope of the findings" in page
    assert "the finding compares it itself" in page


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["all", "--challenge"], "--challenge: not for all, which has several sources. Allowed: one study."),
        (["two_engines", HERE, "--challenge", "9.7"], "--challenge: no finding '9.7'"),
    ],
    ids=["several studies", "no finding"],
)
def test_bad_input_is_one_sentence(cli, engines, arguments, message):
    ending = cli("reproduce", *arguments)
    assert ending.code == 2
    assert ending.err.splitlines()[-1].startswith(f"runner: {message}")


@pytest.mark.parametrize("chosen", ["9.7", "no such finding", "claim 3"])
def test_an_unknown_finding_is_refused_before_anything_runs(cli, engines, chosen):
    ending = cli("reproduce", "two_engines", HERE, "--challenge", chosen)
    assert ending.code == 2
    assert f"--challenge: no finding '{chosen}'" in ending.err
    assert not any((engines.parent / "outputs" / "runs").iterdir())


def test_words_of_a_title_with_values_are_allowed_before_the_runs(engines):
    chapter = engines / "one.md"
    chapter.write_text(chapter.read_text().replace("engines differ\n", "engines differ by {{\napart }} at most\n"))
    study = load_study(str(engines))
    for chosen in ("", "1", "1.1", "the ENGINES differ", "engines differ by 0.3 mm"):
        check_chosen(study, chosen)
    with pytest.raises(RunnerError, match="--challenge: no finding 'foo'"):
        check_chosen(study, "foo")


def test_an_unknown_choice_of_a_finding_names_the_nearest(cli, engines):
    chapter = engines / "one.md"
    chapter.write_text(chapter.read_text().replace("about: engine", "about: engines"))
    ending = cli("reproduce", "two_engines", HERE)
    assert ending.code == 2
    assert "two_engines/one.md:15: about: unknown choice 'engines'" in ending.err


def test_values_that_a_finer_step_moves_are_said():
    def conditions(value):
        return [Measured("time of the pair", value, "s") < 2.0 * Measured("time of the Macro", 1.6, "s")]

    assert list(challenge._moved(conditions(1.6), conditions(1.3))) == ["time of the pair: 1.6 s to 1.3 s"]
    assert list(challenge._moved(conditions(1.6), conditions(1.5))) == []
    assert list(challenge._moved(conditions(1.6), conditions(None))) == []


@pytest.mark.costs(3)
def test_a_finding_about_seeds_is_not_asked(cli, engines):
    chapter = engines / "one.md"
    chapter.write_text(chapter.read_text().replace("about: engine", "about: seeds"))
    ending = cli("reproduce", "two_engines", "--challenge", "which is what it says", HERE)
    assert ending.code == 0
    assert ending.out.splitlines()[1].split("  ")[-1].strip() == "not asked"
