"""The tunings of a study: what runs.yaml says of them, and gains that get from trials into runs and back."""

import pytest
import yaml

from runner.base.errors import RunnerError
from runner.papers.study.execute import make_all
from runner.papers.study.grids import Grids
from runner.papers.study.items import Way
from runner.papers.study.study import load_study
from runner.papers.study.tune import find_gains
from runner.papers.study.tunings import put_in, read_gains, write_gains

HERE = "hydra.sweeper.workers=0"
RUNS = """
grids:
  moves:
    with: [*arm, "{{ law }}", "{{ gains }}"]
    over:
      law: &laws {pd: controller=joint_pd, held: controller=computed_torque}
      gains: {untuned: [], tuned: "gains=planar/{{ law }}/2"}
tunings:
  tune:
    name: planar
    with: [*arm, "{{ law }}", repetitions=2, noise.position=1.0e-4]
    over: {law: *laws}
    ranges: {law: {pd: {controller.natural_frequency: [0.5, 2]}}}
    minimize: rms_tracking_error
    bounds: {torque_chatter: 20}
    trials: 4
    longer: [[*arm, "{{ law }}", repetitions=2, noise.position=1.0e-4, duration=0.4]]
"""
ARM = "[robot=planar, trajectory=quintic, trajectory.duration=0.2, duration=0.2, plant=rk4, plant.step=0.001]"


@pytest.fixture
def paper(tmp_path):
    """Write a study; return a function that opens it with changes of its runs.yaml."""
    folder = tmp_path / "paper"
    folder.mkdir()
    (folder / "study.yaml").write_text(
        "{title: T, source: S, abstract: A, chapters: [a.md], profiles: {anew: {tuned_anew: true}}}"
    )
    (folder / "a.md").write_text("# A\n\nText.\n")

    def opened(*changes, profile=""):
        text = RUNS.replace("*arm", f"&arm {ARM}", 1)
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (folder / "runs.yaml").write_text(text)
        return load_study(str(folder), profile=profile)

    opened.folder = folder
    return opened


def test_each_combination_is_a_tuning_with_its_ranges(paper):
    grids = Grids((paper().folder) / "runs.yaml")
    assert list(grids.tunings) == ["planar/pd", "planar/held"]
    assert grids.tunings["planar/pd"].ranges == {"controller.natural_frequency": (0.5, 2.0)}
    assert grids.tunings["planar/pd"].overrides[-3:] == (
        "controller=joint_pd",
        "repetitions=2",
        "noise.position=1.0e-4",
    )
    assert grids.tunings["planar/held"].ranges == {}
    assert [each[-1] for each in grids.tunings["planar/held"].longer] == ["duration=0.4"]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("gains=planar/", "gains=planer/"), r"run 'moves/pd/tuned': there is no tuning 'planer/pd' \(did you mean"),
        (("{{ law }}/2", "{{ law }}/4"), r"run 'moves/pd/tuned': tuning 'planar/pd' is made 3 times; found 4"),
        (("{{ law }}/2", "{{ law }}/x"), r"gains=planar/pd/x: must end in the number of a tuning, 1 or more"),
        (("{law: {pd:", "{lav: {pd:"), r"ranges: there is no axis 'lav' \(did you mean law\?\)"),
        (("{law: {pd:", "{law: {pe:"), r"ranges.law: no level 'pe' \(did you mean pd\?\)"),
        (("[0.5, 2]", "[1.5, 2]"), r"controller.natural_frequency: its range must be factors below and above 1"),
        (("minimize: rms_tr", "minimize: rmz_tr"), r"there is no metric 'rmz_tracking_error' \(did you mean"),
        (("torque_chatter: 20", "torque_chatter: -1"), r"torque_chatter: must be above 0"),
        (("longer: [[", "longer: [[3, "), r"tunings.tune.longer.0: must be a list of overrides"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(paper, change, told):
    with pytest.raises(RunnerError, match=told):
        paper(change)


def test_a_range_of_factors_needs_a_number_to_begin_with(paper, tmp_path):
    study = paper(("controller.natural_frequency: [", "controller.feedforward: ["))
    with pytest.raises(RunnerError, match=r"planar/pd: controller.feedforward is True; a range of factors needs"):
        find_gains(study.untuned(), Way(tmp_path, (HERE,)))


def test_gains_go_from_trials_into_runs_and_what_is_not_tuned_stays(paper, tmp_path, capsys):
    study = paper()
    assert [tuning.name for tuning in study.untuned()] == ["planar/pd", "planar/held"]
    runs, _ = make_all(study, tmp_path / "outputs", (HERE,))
    first = capsys.readouterr().err.splitlines()[0]  # of one law 2 times 4 trials, of the other, not tuned, 2 times 1
    assert first.startswith("runner: 2 laws on 1 arm: 10 trials in 3 rounds, some 12 long runs, then 3 runs: about ")
    before, after = (runs[f"moves/pd/{gains}"] for gains in ("untuned", "tuned"))
    assert after.metrics["rms_tracking_error"].median < before.metrics["rms_tracking_error"].median
    assert (
        1.0 < after.config["controller"]["natural_frequency"] / before.config["controller"]["natural_frequency"] <= 2.0
    )
    assert runs["moves/held/untuned"].folder == runs["moves/held/tuned"].folder
    assert [len(own) for own in study.tuned.values()] == [2, 2]  # as the runs ask for the second
    assert study.tuned["planar/held"] == [{}, {}]


def test_stored_gains_are_taken_and_a_profile_tunes_anew(paper):
    write_gains(paper.folder, {"planar/pd": [{"controller.natural_frequency": 12.5}] * 3, "planar/held": [{}] * 3})
    jobs = paper().jobs()
    assert jobs["moves/pd/tuned"][-1] == "controller.natural_frequency=12.5"
    assert jobs["moves/held/tuned"] == jobs["moves/held/untuned"]
    assert paper().untuned() == []
    assert len(paper(profile="anew").untuned()) == 2


def test_gains_are_written_as_they_are_read(tmp_path):
    gains = {"arm/law": [{"a.b": 0.125}, {"a.b": 3e-05}, {}]}
    write_gains(tmp_path, gains)
    assert read_gains(tmp_path) == gains
    assert read_gains(tmp_path / "none") == {}
    (tmp_path / "gains.yaml").write_text("arm/law: {a: b}")
    with pytest.raises(RunnerError, match=r"gains.yaml: arm/law"):
        read_gains(tmp_path)


def test_a_tuning_is_made_as_often_as_it_says(paper):
    last = ("{{ law }}/2", "{{ law }}/5"), ("    trials: 4\n", "    trials: 4\n    times: 5\n")
    assert [tuning.times for tuning in paper(*last).untuned()] == [5, 5]


def test_the_gains_of_a_tuning_have_numbers():
    gains = {"arm/law": [{"a": 1.0}, {"a": 2.0}, {"a": 3.0}]}
    assert put_in(("robot=macro", "gains=arm/law/2"), gains) == ("robot=macro", "a=2")
    assert put_in(("gains=other/law/2",), gains) == ("gains=other/law/2",)
    for number in ("0", "x"):
        with pytest.raises(RunnerError, match="must end in the number of a tuning, 1 or more"):
            put_in((f"gains=arm/law/{number}",), gains)
    with pytest.raises(RunnerError, match=r"gains=arm/law/4: gains.yaml has the gains of 3 tunings"):
        put_in(("gains=arm/law/4",), gains)


def test_a_law_of_the_reader_s_has_its_ranges_beside_its_module(paper, tmp_path):
    from runner.papers.study.code import UserPlugin

    mine = tmp_path / "mine"
    (mine / "controller").mkdir(parents=True)
    part = UserPlugin("controller", "spring", str(mine / "spring.py"), mine)
    study = paper(("over: {law: *laws}\n", "over: {law: *laws}\n    plugins: {law: controller}\n"))
    path = study.folder / "runs.yaml"
    assert Grids(path, None, [part]).tunings["planar/spring"].ranges == {}
    (mine / "spring.ranges.yaml").write_text(yaml.safe_dump({"controller.stiffness": [0.1, 10]}))
    assert Grids(path, None, [part]).tunings["planar/spring"].ranges == {"controller.stiffness": (0.1, 10.0)}
    (mine / "spring.ranges.yaml").write_text(yaml.safe_dump({"controller.stiffness": [2, 10]}))
    with pytest.raises(RunnerError, match=r"spring.ranges.yaml: controller.stiffness: its range must be"):
        Grids(path, None, [part])


@pytest.mark.costs(2)
def test_a_tuning_asked_for_twice_is_found_stored(paper, tmp_path, capsys):
    study = paper()
    way = Way(tmp_path / "outputs", (HERE,))
    first = find_gains(study.untuned(), way)
    capsys.readouterr()
    assert find_gains(study.untuned(), way) == first
    told = capsys.readouterr().err
    assert "6 runs, 6 of them stored already" in told  # of two seeds 2 trials of one law, and 1 of the other
    assert "longer runs of 4 trials ..." in told
    assert "runner: 2 runs, 2 of them stored already" in told  # a further trial in each of the rounds that follow
