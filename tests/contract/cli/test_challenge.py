"""`runner challenge`: its question, list, budget, continuation, page and check, and bad input."""

import re
import shutil
from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support.engines import ASKED

import runner
from runner.assembly.validation import validate
from runner.base.dotted_keys import split_override
from runner.config.compose.compose import compose
from runner.reporting.challenge.question import read_question
from runner.reporting.challenge.words import TITLES, answer_text, scope_sentences
from runner.reporting.document import Curves
from runner.reporting.mathml import faulty
from runner.reporting.stored import compose_report
from runner.statistics.scope import first_pairs
from runner.sweeps.challenge.case import Case, check_case
from runner.sweeps.challenge.combinations import combine
from runner.sweeps.challenge.drawn import read_drawn
from runner.sweeps.challenge.families import FAMILIES, NotApplicableError, _duration, _step
from runner.sweeps.challenge.question import CLASSES
from runner.sweeps.challenge.stored import open_challenge
from runner.sweeps.challenge.table import change_values, list_variations, read_values

TASK = ("robot=macro", "plant=rk4", ASKED, "trajectory=quintic", "trajectory.duration=0.5", "duration=0.6",
        "noise=thesis", "repetitions=6")  # fmt: skip
GAIN = "controller.natural_frequency"
GAINS = f"{GAIN}=20,40"
FEW = ("--without", "engine,goal,direction,velocity,noise_kind,torque_limit,payload,friction,delay,period,model_error")
LIST = ("--vary", "duration=0.5,2", "--vary", "gain_of_one=0.25,0.5", "--vary", "gain=0.5")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A sweep over two gains, made once."""
    folder = tmp_path_factory.mktemp("challenge") / "outputs"
    runner.sweep(*TASK, GAINS, f"outputs={folder}", workers=0)
    return folder


@pytest.fixture(name="sweep")
def _sweep(made, tmp_path):
    """A copy of the sweep in the working directory."""
    shutil.copytree(made, tmp_path / "outputs")
    (folder,) = (tmp_path / "outputs" / "sweeps").iterdir()
    return folder


@pytest.fixture(scope="module", name="ended")
def _ended(made, tmp_path_factory):
    """A challenge of the sweep, made once."""
    folder = tmp_path_factory.mktemp("ended") / "outputs"
    shutil.copytree(made, folder)
    (sweep,) = (folder / "sweeps").iterdir()
    values = {"duration": [0.5, 2], "gain_of_one": [0.25, 0.5], "gain": [0.5]}
    without = FEW[1].split(",")
    return runner.challenge(sweep, by="controller.natural_frequency", vary=values, without=without, workers=0)


def test_every_family_has_a_title_and_the_file_names_each_in_its_class():
    values = read_values(())
    assert set(values) == set(FAMILIES) == set(TITLES)
    assert all(family.kind in CLASSES for some in FAMILIES.values() for family in some)


@pytest.mark.costs(12)
def test_words_of_a_difference_that_gains_make(ended):
    found = {one.variation.label: one.judged for one in ended.found}
    assert ended.came_back
    assert ended.ended
    assert ended.fresh.pairs == first_pairs(len(found))
    assert ended.question.sign == -1  # twice the natural frequency follows better
    assert {found[label].word for label in found if "step" in label or "noise" in label} == {"holds"}
    half = "0.5 times the main gain of only controller.natural_frequency=40"
    quarter = "0.25 times the main gain of only controller.natural_frequency=40"
    assert found[half].word == "vanishes"  # both sides are the same law
    assert found[quarter].word == "reversed"
    assert found["a motion of 0.25 s"].word == "neither works"  # neither gain follows so fast a motion
    assert found["a motion of 1 s"].word in ("holds", "holds, weaker")


def test_a_weaker_answer_is_said_with_its_size_and_does_not_hold_as_its_family(ended):
    def weaken(*labels):
        found = [
            replace(one, judged=replace(one.judged, word="holds, weaker", effect=-0.051))
            if one.variation.label in labels
            else one
            for one in ended.found
        ]
        return scope_sentences(replace(ended, found=found))

    slow, finer = "a motion of 1 s", "a step 5 times finer"
    assert f"Holds, but weaker, with {slow} (-5.1 %)." in weaken(slow)
    assert not any(text.startswith("Not settled") for text in weaken(slow))
    assert f"Not settled numerically: {finer} (holds, weaker)." in weaken(finer)


def test_combinations_are_described_and_count_in_no_class(ended):
    assert {one.pairs for one in ended.combined} == {ended.fresh.pairs}
    too_fast = [one for one in ended.combined if "a motion of 0.25 s" in one.labels]  # neither gain follows it
    others = [one for one in ended.combined if one not in too_fast]
    assert too_fast
    assert others
    assert {one.effect for one in too_fast} == {None}
    assert all(one.effect < -0.02 for one in others)  # twice the frequency follows better at each noise
    said = next(text for text in ended.sentences if "combinations" in text)
    assert said.startswith(f"{len(ended.combined)} combinations of two to four changes (seed 1), not tested: ")
    assert f"the same sign in {len(others)}, within 2 % in 0, the other sign in 0 (" in said
    assert said.endswith(f" %), a side does not work in {len(too_fast)}.")
    assert len({frozenset(one.labels) for one in ended.combined}) == len(ended.combined)


def test_combinations_are_balanced_and_never_set_a_key_twice(sweep):
    found, _ = list_variations(check_case(read_question([sweep])), read_values(()))
    combined = list(combine(found, 3))
    assert combined == list(combine(found, 3)) != list(combine(found, 4))
    assert {len(one.labels) for one in combined} == {2, 3, 4}
    counts = Counter(label for one in combined for label in one.labels)
    allowed = {one.label for one in found if one.kind in ("equivalent", "conditions")}
    assert set(counts) <= allowed
    assert max(counts.values()) - min(counts[label] for label in allowed) <= 2
    for one in combined:
        keys = [split_override(text)[0] for text in one.sides[0]]
        assert len(keys) == len(set(keys))
    assert list(combine([one for one in found if one.kind == "numbers"], 3)) == []


def test_a_reversal_turns_where_both_sides_have_one_gain(ended):
    turning = next(one for one in ended.turnings if "0.25" in ended.found[one.variation].variation.label)
    (turn,) = turning.turns
    assert [turn.low, turn.value, turn.high] == pytest.approx([0.5, 0.5, 0.5], abs=1e-4)  # the same runs there


def test_the_question_and_the_list_are_stored_and_read_back(ended):
    again = runner.open_challenge(ended.folder)
    assert again == ended
    assert again.sentences[0].startswith("Largest tracking error: ")
    frame = again.to_frame()
    assert list(frame["family"]) == [one.variation.family for one in ended.found]
    assert repr(again).startswith("Challenge: Largest tracking error: ")
    assert runner.open_challenge(ended.folder).question.asks


def test_only_the_extreme_variations_keep_a_trace(ended):
    told = [one for one in ended.found if one.judged.effect is not None]
    effects = sorted(told, key=lambda one: one.judged.effect)
    extreme = {name for one in (effects[0], effects[-1]) for name in one.hashes}
    runs = ended.folder.parent.parent / "runs"
    own = {name for one in ended.found for name in one.hashes}
    assert {path.name for path in runs.iterdir()} & own == extreme


def test_page_with_the_specification_curve(ended, tmp_path):
    document, _ = compose_report([ended.folder], output=tmp_path)
    assert faulty(document) == []
    titles = [section.title for section in document.sections]
    assert titles[:3] == ["Variations", "Where it turns", "Several changes at once"]
    curve, table = document.sections[0].blocks
    drawn, chosen = ({hint for series in panel.series for hint in series.hints} for panel in curve.panels)
    assert len(chosen) == len(ended.found) == len(table.rows) - len(ended.left_out)
    assert all("runner " in hint for hint in chosen)
    unknown = {hint for hint in chosen if "works" in hint or "work;" in hint}
    assert drawn == chosen - unknown


def test_check_of_the_scope(cli, ended):
    ending = cli("check", ended.folder, "--require-scope", "numbers")
    assert (ending.code, ending.out) == (0, "good: the answer holds for numbers\n")
    ending = cli("check", ended.folder, "--require-scope", "numbers,fairness")
    assert ending.code == 1
    assert "natural_frequency=40: reversed" in ending.out
    for words in (["--require-scope", "luck"], [], ["--require-scope", "numbers", "--baseline", "x.yaml"]):
        assert cli("check", ended.folder, *words).code == 2


@pytest.mark.costs(4)
def test_a_budget_cuts_and_the_sentence_says_so(cli, sweep):
    words = ("challenge", sweep, "--by", "controller.natural_frequency", *FEW, *LIST)
    ending = cli(*words, "--budget", 1, "-j", 1)
    assert ending.code == 0
    found = open_challenge(ending.folder)
    cut = f"9 variations, {len(found.combined)} combinations."
    assert f"Not tried within the budget of 1 variation: {cut}" in ending.out
    assert f"not tried within the budget: {cut}" in cli("compare", sweep, "--by", GAIN).out
    assert len(found.cut) == len(found.found) - 1
    again = cli("check", ending.folder, "--require-scope", "conditions")
    assert (again.code, "not tried: budget" in again.out) == (1, True)
    listed = cli("results")
    assert "challenge" in listed.out


@pytest.mark.costs(3)
def test_an_interrupted_challenge_is_continued_with_the_stored_runs(cli, sweep, monkeypatch):
    from runner.sweeps.challenge import run as module

    words = ("challenge", sweep, "--by", "controller.natural_frequency", *FEW, "--budget", 1, "-j", 1)

    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(module, "judge_in_looks", interrupt)
        assert cli(*words).code == 130
    (folder,) = (sweep.parent.parent / "challenges").iterdir()
    assert "interrupted" in scope_sentences(open_challenge(folder))[0]
    stored = {path: path.stat().st_mtime_ns for path in (folder.parent.parent / "shards").iterdir()}
    ending = cli(*words)
    assert (ending.code, ending.folder) == (0, folder)
    lines = [line for line in ending.err.splitlines() if "pairs" in line]
    assert lines == ["runner: the asked case on fresh seeds, 12 pairs", "runner: 1 variation, 12 pairs each"]
    assert {path: path.stat().st_mtime_ns for path in stored} == stored  # the asked case is not simulated again


@pytest.mark.costs(2)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--by", "robot"], "--by: unknown axis 'robot'. Allowed: controller.natural_frequency."),
        (["--without", "noize"], "--without: unknown family 'noize'."),
        (["--without", "noize"], "Did you mean 'noise'?"),
        (["--vary", "noize=2"], "--vary: unknown family 'noize'."),
        (["--vary", "gravty=2"], "Did you mean 'gravity'?"),
        (["--vary", "controller.damping_ration=2"], "--vary: unknown key 'controller.damping_ration'. Allowed: "),
        (["--vary", "controller.damping_ration=2"], "Did you mean 'controller.damping_ratio'?"),
        (["--vary", "contoller.period=2"], "Did you mean 'controller.period'?"),
        (["--vary", "noise"], "--vary: no values ('noise'). Allowed: KEY=A,B"),
        (["--vary", "noise=much"], "challenge.noise: not a value of this family ('much')."),
        (["--budget", "0"], "--budget: not a budget ('0'). Allowed: a time such as 60s"),
        (["--metrics", "speed"], "unknown metric 'speed'"),
        (["--metrics", "a,b"], "--metrics: several names (a,b). Allowed: one."),
        (["--budget", "0.001s"], "--budget: too small for the asked case (0.001s)."),
    ],
)
def test_bad_input_is_one_sentence(cli, sweep, words, said):
    ending = cli("challenge", sweep, *words)
    assert ending.code == 2
    assert said in ending.err


def test_results_without_a_comparison(cli, runs):
    ending = cli("challenge", runs["goal"].folder)
    assert ending.code == 2
    assert "no comparison. Allowed: a sweep, a tuning, two sweeps or two runs." in ending.err


def test_what_does_not_apply_is_left_out_with_its_reason(sweep):
    case = check_case(read_question([sweep]))
    values = change_values(read_values(()), ["noise=0.5"], ["torque_limit"])
    found, left = list_variations(case, values)
    assert left == []
    assert [one.value for one in found if one.family == "noise"] == [0.5]
    assert not [one for one in found if one.family == "torque_limit"]
    assert change_values({}, ["a.b=[1,2],[3,4]", "gravity=9"], []) == {"a.b": ["[1,2]", "[3,4]"], "gravity": [9.0]}
    order = [list(CLASSES).index(one.kind) for one in found]
    assert order == sorted(order)


@pytest.mark.parametrize(("whole", "value", "simulated"), [(3.0, 0.5, 2.0), (1.0, 0.5, 0.5), (1.0, 2.0, 2.0)])
def test_a_slower_motion_is_cut_off_at_the_same_share(whole, value, simulated):
    config = validate(compose(["robot=macro", "trajectory=quintic", "trajectory.duration=2", f"duration={whole}"]))
    changed = _duration(Case((), (config,)), value)
    assert changed.sides == [[f"trajectory.duration={2.0 * value}", f"duration={simulated}"]]


def test_a_plant_that_integrates_nothing_has_no_finer_step():
    line = ("robot=meca500", "plant=kinematic", "controller=differential_inverse_kinematics", "trajectory=quintic")
    config = validate(compose(line))
    with pytest.raises(NotApplicableError, match="the plant integrates nothing"):
        _step(Case((), (config, config)), 0.2)


def test_verify_reads_a_challenge_as_one(cli, ended, tmp_path):
    folder = tmp_path / "outputs" / "challenges" / ended.folder.name
    shutil.copytree(ended.folder, folder)
    assert cli("verify").out == "challenges: 1 as written\n"
    (folder / "challenge.json").write_text((folder / "challenge.json").read_text().replace("reversed", "holds"))
    assert "challenges: 1 damaged" in cli("verify").out


def test_a_damaged_challenge_is_told(cli, ended, tmp_path):
    folder = tmp_path / "outputs" / "challenges" / ended.folder.name
    shutil.copytree(ended.folder, folder)
    file = folder / "challenge.json"
    file.write_text(file.read_text().replace("reversed", "holds"))
    ending = cli("report", folder)
    assert ending.code == 2
    assert "the challenge's command writes it again" in ending.err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("numbers: {step: [0.5]}\nequivalent: {}\nconditions: {}\nfairness: {}\n", ""),
        ("numbers: {gain: [0.5]}\nequivalent: {}\nconditions: {}\nfairness: {}\n", "gain is in numbers. Allowed: in"),
        ("numbers: {stop: [0.5]}\nequivalent: {}\nconditions: {}\nfairness: {}\n", "unknown family 'stop'"),
        ("numbers: []\n", "not a table of variations"),
    ],
)
def test_a_table_of_your_own(tmp_path, text, said):
    (tmp_path / "challenge").mkdir()
    (tmp_path / "challenge" / "standard.yaml").write_text(text)
    if not said:
        assert read_values([tmp_path]) == {"step": [0.5]}
        return
    with pytest.raises(runner.RunnerError, match=said):
        read_values([tmp_path])


def test_conclusions_stand_beside_their_scope(cli, sweep, ended):
    words = ("compare", sweep, "--by", "controller.natural_frequency")
    said = rf"Not challenged: `runner challenge {sweep}` \(about \d+ s, longer at first use\) tries other choices\."
    assert re.search(said, cli(*words).out)
    assert re.search(said, runner.open_sweep(sweep).compare(by="controller.natural_frequency").summary)
    shutil.copytree(ended.folder, sweep.parent.parent / "challenges" / ended.folder.name)
    assert "Challenged: it holds for all tried numerical choices; it ends or turns with" in cli(*words).out


@pytest.mark.costs(6)
@pytest.mark.parametrize("kind", ["two runs", "two sweeps", "tuning"])
def test_other_subjects_say_their_scope_beside_every_conclusion(cli, kind):
    """Command line, page and Python name the command; after the challenge they say its sentence."""
    if kind == "tuning":
        search = {GAIN.replace(".", "__"): (10.0, 20.0), "minimize": "max_tracking_error"}
        folders = [runner.tune(*TASK, **search, trials=2, workers=0).folder]
    elif kind == "two runs":
        folders = [runner.run(*TASK, f"{GAIN}={value}").folder for value in (20, 40)]
    else:
        folders = [runner.sweep(*TASK, f"{GAIN}={value}", "robot=macro", workers=0).folder for value in (20, 40)]
    command = f"runner challenge {' '.join(map(str, folders))}"

    def said():
        abstract = compose_report(folders)[0].abstract
        if kind == "tuning":
            return abstract, abstract
        return abstract, cli("compare", *folders).out, runner.compare(*folders).summary

    page, *others = said()
    assert page.count("Not challenged: the command runner challenge") == 1
    assert all(text.count(f"`{command}` (about") == 1 for text in others if kind != "tuning")
    ending = cli("challenge", *folders, *FEW, "--budget", 1, "-j", 1)
    assert ending.code == 0
    assert "Settled numerically (a step 5 times finer)." in ending.out
    assert all(text.count("Challenged: it holds for all tried numerical choices") == 1 for text in said())


def test_without_a_conclusion_there_is_no_scope(cli):
    folders = [runner.run(*TASK[:-1], "repetitions=2", f"seed={seed}").folder for seed in (0, 1)]
    assert "hallenge" not in cli("compare", *folders).out
    assert "hallenge" not in compose_report(folders)[0].abstract


def test_a_section_of_a_plug_in_is_before_the_provenance(ended, own_section, tmp_path):
    own_section("challenge", "f'{len(subject.sweep.hashes)} runs'")
    *_, own, _ = compose_report([ended.folder], output=tmp_path)[0].sections
    assert own.blocks[0].text.endswith(" runs")


@pytest.mark.parametrize(("sign", "said"), [(-1, "smaller with b than with a"), (1, "smaller with a than with b")])
def test_a_share_of_the_larger_side_says_which_one_is_smaller(sign, said):
    sides = [SimpleNamespace(name=name) for name in "ab"]
    question = SimpleNamespace(sides=sides, sign=sign, size=0.29, is_fraction=False)
    assert answer_text(SimpleNamespace(question=question, fresh=None)) == f"29 % {said}"


FAILS = ("robot=macro", "controller=computed_torque", "trajectory=goal", "duration=0.8", "controller.period=10ms,20ms")
BUDGET = ("--budget", 2, "-j", 1, "--metrics", "settling_time")


@pytest.mark.costs(2)
@pytest.mark.parametrize("noise", [(), ("noise=thesis", "repetitions=6")], ids=["exact", "drawn"])
def test_an_answer_of_which_one_side_has_no_value(cli, noise, tmp_path):
    runner.sweep(*FAILS, *noise, workers=0)
    ending = cli("challenge", "latest", *BUDGET)
    assert ending.code == 0
    said = "only controller.period=0.01 has a value, controller.period=0.02 has none"
    assert said in ending.out
    assert "Settled numerically (the engine mujoco; the engine rk4)." in ending.out
    made = open_challenge(ending.folder)
    assert made.question.size is None
    assert {one.judged.word for one in made.found if one.judged} == {"only one works"}
    document = compose_report([made.folder], output=tmp_path)[0]
    assert said in document.abstract
    blocks = [block for section in document.sections for block in section.blocks]
    assert not any(isinstance(block, Curves) for block in blocks)  # no difference is known
    assert not faulty(document)
    assert "damaged" not in cli("results").out
    again = cli("check", made.folder, "--require-scope", "numbers")
    assert again.out.splitlines()[-1] == "not shown to hold for numbers: 1"  # the one that the budget cut


def _works_always(run, metric):
    nothing = np.zeros(run.repetitions, dtype=bool)
    return replace(read_drawn(run, metric), lost=nothing, spoilt=nothing)


def test_no_share_of_an_infinite_difference_ends_an_answer(cli, monkeypatch):
    runner.sweep(*FAILS, workers=0)
    monkeypatch.setattr("runner.sweeps.challenge.bench.read_drawn", _works_always)
    out = cli("challenge", "latest", *BUDGET).out
    assert "Settled numerically (the engine mujoco; the engine rk4)." in out
    assert "inf" not in out
