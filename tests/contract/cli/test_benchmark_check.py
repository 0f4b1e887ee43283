"""`runner benchmark check`: laws that fit and laws that do not, against a small study with one built-in law."""

import re
import shutil
import sys
from pathlib import Path

import pytest

from runner.base.errors import RunnerError
from runner.papers.commands.benchmark import check_law
from runner.papers.study.code import read_user_plugins

EXAMPLE = Path(__file__).parents[3] / "examples" / "own_robot"
LAW = "gravity_pd"
CONFIG, RANGES = f"controller/{LAW}.yaml", f"{LAW}.ranges.yaml"
RUNS = """\
grids:
  move:
    with: [&arm [robot=planar, trajectory=quintic, trajectory.duration=0.2, plant=rk4], "{{ law }}", "{{ gains }}"]
    over:
      law: &laws {pd: controller=joint_pd}
      condition: {exact: duration=0.2, friction: [duration=0.2, plant.friction.coulomb=0.1]}
      gains: {untuned: [], "1": "gains=planar/{{ law }}/1", "2": "gains=planar/{{ law }}/2"}
    plugins: &plugins {law: controller}
tunings:
  planar:
    with: [*arm, "{{ law }}", duration=0.2, repetitions=2]
    over: {law: *laws}
    ranges: {law: {pd: {controller.natural_frequency: [0.5, 2]}}}
    minimize: rms_tracking_error
    trials: 8
    longer: [[*arm, "{{ law }}", duration=1, repetitions=2]]
    plugins: *plugins
"""


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A folder with a user's law, which is in use, and a study that takes it."""
    (tmp_path / "mine" / "controller").mkdir(parents=True)
    for file in (f"{LAW}.py", CONFIG):
        shutil.copy(EXAMPLE / file, tmp_path / "mine" / file)
    ranges = "controller.natural_frequency: [0.2, 1.5]\ncontroller.damping_ratio: [0.5, 1.5]\n"
    (tmp_path / "mine" / RANGES).write_text(ranges)
    (tmp_path / "paper").mkdir()
    (tmp_path / "paper" / "study.yaml").write_text("{title: T, source: S, abstract: A, chapters: [a.md]}")
    (tmp_path / "paper" / "a.md").write_text("# A\n\nText.\n")
    (tmp_path / "paper" / "runs.yaml").write_text(RUNS)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setenv("RUNNER_PLUGINS", f"controller={tmp_path / 'mine' / LAW}.py")
    sys.modules.pop(LAW, None)
    yield tmp_path / "mine"
    sys.modules.pop(LAW, None)


def told(mine):
    (part,) = read_user_plugins([f"controller={mine / LAW}.py"])
    return [*check_law(str(mine.parent / "paper"), "", part, 2)]


def refused(mine):
    with pytest.raises(RunnerError) as error:
        told(mine)
    first, *problems = str(error.value).splitlines()
    assert first == "gravity_pd does not fit:"
    return problems


def changed(path, old, new):
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))


def test_a_law_that_fits_is_told_what_there_is_to_make(mine):
    arm, total = told(mine)
    # Two tunings of 8 trials, each with a long run in three rounds; 2 conditions untuned and with two gains.
    assert re.fullmatch(r"planar: a control tick of 1 ms computed in \d+ us; 16 trials, 6 long runs, 6 runs", arm)
    assert re.fullmatch(
        r"gravity_pd on 1 arm: 16 trials in 3 rounds, some 6 long runs, then 6 runs: about \d+ \w+ on 2 processes for "
        "all", total
    )  # fmt: skip
    assert not (mine.parent / "outputs").exists()


def test_a_law_without_ranges_has_one_trial_of_each_tuning_and_the_same_run_with_all_gains(mine):
    (mine / f"{LAW}.ranges.yaml").unlink()
    arm, alone, _ = told(mine)
    assert arm.endswith("; 2 trials, 6 long runs, 2 runs")
    assert alone == "no ranges in gravity_pd.ranges.yaml: the law is compared only with the values of its config"


@pytest.mark.parametrize(
    ("file", "old", "new", "problem"),
    [
        (CONFIG, "approach: 20.0", "aproach: 20.0", "exact/untuned and 3 more: controller.aproach: unknown key"),
        (
            CONFIG,
            "${robot.period}",
            "0.002",
            "and 2 more: controller.period is 0.002 for gravity_pd and 0.001 for joint_pd",
        ),
        (CONFIG, "kind: gravity_pd", "kind: joint_pd", "kind: must be 'gravity_pd', .*; found 'joint_pd'"),
        (f"{LAW}.py", "return torque", "return torque[:1]", r"gave an array of shape \(1,\); it must be an array of"),
        (f"{LAW}.py", "return torque", "return torque / 0", "at 0 s: RuntimeWarning: divide by zero"),
        (f"{LAW}.py", "import numpy", "import numpie", "module gravity_pd cannot be imported: .*numpie"),
        (RANGES, "damping_ratio", "damping", "planar/gravity_pd: controller.damping is None; a range of factors needs"),
        (
            RANGES,
            "controller.damping_ratio",
            "trajectory.duration",
            "gravity_pd with trajectory.duration=0.1 and 0.2 for",
        ),
    ],
)
def test_what_does_not_fit_is_told_in_a_sentence(mine, file, old, new, problem):
    changed(mine / file, old, new)
    assert re.search(problem, "\n".join(refused(mine)))


def test_a_file_of_the_folder_with_the_name_of_one_of_ours_is_seen(mine):
    (mine / "trajectory").mkdir()
    (mine / "trajectory" / "quintic.yaml").write_text("{kind: quintic, duration: 1.0}\n")
    (problem,) = refused(mine)
    assert re.search(
        "exact/untuned and 3 more: trajectory: 'quintic' is a built-in option.*; rename that file", problem
    )


def test_a_law_called_as_one_of_ours_is_refused(mine):
    (mine / f"{LAW}.py").rename(mine / "impedance.py")
    (mine / "controller" / f"{LAW}.yaml").rename(mine / "controller" / "impedance.yaml")
    changed(mine / "controller" / "impedance.yaml", "kind: gravity_pd", "kind: impedance")
    (part,) = read_user_plugins([f"controller={mine}/impedance.py"])
    with pytest.raises(RunnerError, match=r"is a built-in option|no name of a law of ours"):
        [*check_law(str(mine.parent / "paper"), "", part, 2)]


def test_an_end_of_a_range_that_the_law_refuses_is_told(mine):
    changed(mine / f"{LAW}.py", "damping_ratio: PositiveFloat", "damping_ratio: float = Field(lt=1.2)")
    changed(mine / f"{LAW}.py", "import PositiveFloat", "import Field, PositiveFloat")
    (problem,) = refused(mine)
    assert "planar/gravity_pd with controller.damping_ratio=1.5: controller.damping_ratio: must be below 1.2" in problem


@pytest.mark.costs(9)
def test_the_example_fits_in_the_benchmark(cli, monkeypatch):
    monkeypatch.setenv("RUNNER_PLUGINS", "")
    ending = cli("benchmark", "check", EXAMPLE / f"{LAW}.py")
    assert (ending.code, ending.err) == (0, "")
    *arms, total, command = ending.out.splitlines()
    assert [line.partition(":")[0] for line in arms] == ["macro", "planar", "xarm7", "panda"]
    assert total.startswith("gravity_pd on 4 arms: ")
    assert command == f"runner reproduce benchmark --plugin controller={EXAMPLE}/{LAW}.py"


def test_what_cannot_be_found_is_bad_input(cli, mine, monkeypatch):
    monkeypatch.setenv("RUNNER_PLUGINS", "")
    assert "no file nowhere.py" in cli("benchmark", "check", "nowhere.py").err
    (mine / "controller" / f"{LAW}.yaml").unlink()
    ending = cli("benchmark", "check", mine / f"{LAW}.py")
    assert (ending.code, "no config next to it" in ending.err) == (2, True)
