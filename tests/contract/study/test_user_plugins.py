"""A control law of the user in a study: its runs and their commands, and what is refused."""

import shutil
import sys
from pathlib import Path

import pytest

from runner.base.errors import RunnerError
from runner.papers.study.code import read_user_plugins
from runner.papers.study.grids import Grids
from runner.papers.study.study import load_study

EXAMPLE = Path(__file__).parents[3] / "examples" / "own_robot"
LAW = "gravity_pd"
GRIDS = """\
grids:
  laws:
    with: [robot=macro, trajectory=quintic, plant=rk4, duration=0.1, trajectory.duration=0.1]
    over: {law: {joint PD: controller=joint_pd}, seed: [0, 1]}
    plugins: {law: controller}
  alone: {with: [robot=macro, duration=0.02]}
"""
FILES = {
    "study.yaml": "title: T\nsource: S\nabstract: A\nchapters: [one.md]\n",
    "runs.yaml": GRIDS,
    "one.md": '# One\n\n{{ table("Laws.", "laws/{law}/{seed}", level("law"), column("torque", "peak_torque")) }}\n',
}


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A folder with a user's law and its config, and a study that takes such, with no part named yet."""
    monkeypatch.setenv("RUNNER_PLUGINS", "")
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "mine" / "controller").mkdir(parents=True)
    for file in (f"{LAW}.py", f"controller/{LAW}.yaml"):
        shutil.copy(EXAMPLE / file, tmp_path / "mine" / file)
    (tmp_path / "paper").mkdir()
    for name, text in FILES.items():
        (tmp_path / "paper" / name).write_text(text)
    yield tmp_path / "mine"
    sys.modules.pop(LAW, None)


@pytest.fixture
def part(mine):
    return read_user_plugins([f"controller={mine / LAW}.py"])


def grids(tmp_path, text, parts):
    path = tmp_path / "grids.yaml"
    path.write_text(text)
    return Grids(path, None, parts)


def test_a_given_part_is_one_more_level_of_the_axis_that_takes_it(mine, part):
    runs = load_study(str(mine.parent / "paper"), parts=part).jobs()
    assert list(runs) == [
        "laws/joint PD/0", "laws/joint PD/1", "laws/gravity_pd/0", "laws/gravity_pd/1", "alone"
    ]  # fmt: skip
    assert runs["laws/gravity_pd/1"][-2:] == ("controller=gravity_pd", "seed=1")


def test_of_listed_levels_it_is_one_more_value(tmp_path, part):
    text = "grids: {g: {over: {controller: [joint_pd]}, plugins: {controller: controller}}}"
    assert grids(tmp_path, text, part).runs == {
        "g/joint_pd": ("controller=joint_pd",),
        "g/gravity_pd": ("controller=gravity_pd",),
    }


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{g: {over: {law: [joint_pd]}, plugins: {lwa: controller}}}", "plugins: there is no axis 'lwa'.*mean law"),
        ("{g: {over: {law: [joint_pd]}, plugins: {law: metric}}}", "plugins.law"),
        ("{g: {over: {law: {gravity_pd: a=1}}, plugins: {law: controller}}}", "grids.g: axis 'law' has a level 'gravi"),
    ],
)
def test_what_is_wrong_with_an_axis_that_takes_parts_is_told(tmp_path, part, text, told):
    with pytest.raises(RunnerError, match=told):
        grids(tmp_path, f"grids: {text}", part)


def test_the_command_of_a_run_names_the_part_that_it_uses(mine, part, monkeypatch):
    monkeypatch.chdir(mine.parent)
    study = load_study("./paper", parts=part)
    own, *both = ("--config-dir", "paper"), "--config-dir", "mine", "--plugin", "controller=mine/gravity_pd.py"
    assert study.options(("robot=macro", "controller=gravity_pd")) == (*own, *both)
    assert study.options(("robot=macro", "controller=joint_pd")) == own


@pytest.mark.costs(2)
def test_the_law_stands_in_the_report_and_a_second_time_nothing_is_simulated(cli, mine):
    command = ("reproduce", "--plugin", f"controller=mine/{LAW}.py", "paper", "hydra.sweeper.workers=0")
    ending = cli(*command)
    assert (ending.code, "gravity_pd" in (ending.folder / "report.html").read_text()) == (0, True)
    (sweep,) = (mine.parent / "outputs" / "sweeps").iterdir()
    assert "runner --plugin controller=mine/gravity_pd.py reproduce paper" in (sweep / "sweep.json").read_text()
    records = {path: path.stat().st_mtime_ns for path in (mine.parent / "outputs" / "runs").glob("*/metrics.json")}
    assert len(records) == 5
    assert cli(*command).code == 0
    assert {path: path.stat().st_mtime_ns for path in records} == records


def test_a_study_that_takes_none_refuses_it(cli, mine):
    (mine.parent / "paper" / "runs.yaml").write_text("grids: {alone: {with: [robot=macro, duration=0.02]}}\n")
    ending = cli("reproduce", "paper", "--plugin", f"controller=mine/{LAW}.py")
    assert ending.code == 2
    assert "paper: --plugin controller=gravity_pd: none of its runs takes a controller of yours" in ending.err
    ending = cli("reproduce", "all", "--plugin", f"controller=mine/{LAW}.py")
    assert (ending.code, "--plugin: not for several studies (all). Allowed: one study." in ending.err) == (2, True)
    assert not (mine.parent / "outputs").exists()


def test_a_law_without_its_config_is_told_where_that_belongs(cli, mine):
    (mine / "controller" / f"{LAW}.yaml").unlink()
    ending = cli("reproduce", "paper", "--plugin", f"controller=mine/{LAW}.py")
    assert ending.code == 2
    assert f"no config next to it, {mine.resolve()}/controller/gravity_pd.yaml" in ending.err
