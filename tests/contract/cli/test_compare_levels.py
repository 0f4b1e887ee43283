"""`runner compare SWEEP --by AXIS`: the levels of an axis within those of the others."""

import shutil
from types import SimpleNamespace

import pytest

import runner
from runner.base.errors import RunnerError
from runner.cli.compare import _check_levels

TASK = ("robot=macro", "duration=0.05", "noise=thesis", "repetitions=8", "hydra.sweeper.workers=0")


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Outputs for all tests: the sweep is made once; the shared one of twelve cells has no axis of laws."""
    return f"outputs={tmp_path_factory.mktemp('levels')}"


@pytest.fixture(name="folder")
def _folder(cli, outputs):
    laws = "controller=computed_torque,operational_space"
    return cli("-m", *TASK, outputs, "trajectory=quintic", laws, "gravity=9.81,9.7").folder


def rows(out, metric):
    return [line.split() for line in out.splitlines() if metric in line.split()]


def test_levels_are_compared_within_each_level_of_the_other_axis(cli, folder):
    ending = cli("compare", folder, "--by", "controller", "--metrics", "rms_torque", "--all")
    assert (ending.code, ending.err) == (0, "")
    first, *others = rows(ending.out, "rms_torque")
    assert [first[0], *(row[0] for row in others)] == ["all", "gravity=9.7", "gravity=9.81"]
    assert first[1:3] == ["computed_torque,", "operational_space"]
    assert "\nRms torque: " in ending.out  # the answer is before the table
    assert "corrected for all comparisons of a metric" in ending.out
    assert "peak_torque" not in ending.out


def test_axes_that_are_not_named_are_pooled(cli, folder):
    axis = ("--by", "gravity", "--within", "controller", "--metrics", "rms_torque", "--all")
    assert [row[0] for row in rows(cli("compare", folder, *axis).out, "rms_torque")] == [
        "controller=computed_torque",
        "controller=operational_space",
    ]


def test_what_goes_with_an_axis_is_told_before_any_number(cli):
    folder = cli("-m", *TASK, "trajectory=quintic", "controller.period=0.01,0.005").folder
    out = cli("compare", folder, "--by", "controller.period", "--metrics", "rms_torque").out
    head = out.partition("Rms torque: ")[0]
    assert "the levels of controller.period differ in more than controller.period" in head
    assert "plant.step" in head


def test_the_answer_comes_first_and_every_metric_when_asked(cli, folder):
    short, whole = (cli("compare", folder, "--by", "controller", *more).out for more in ((), ("--all",)))
    first = short.split("\n\n")[1].splitlines()[0]
    assert first.startswith("Largest tracking error: ")
    assert "computed_torque (" in first
    table = short[short.index("\nmetric ") :].splitlines()
    assert table[1].split("  ")[0] == "metric"
    assert len(table) <= 14
    assert "--all prints every metric" in short
    assert "peak_torque_q1" in whole
    assert "peak_torque_q1" not in short


def test_an_interrupted_sweep_says_which_values_its_answer_lacks(cli, folder, tmp_path):
    shutil.copytree(folder.parent.parent, tmp_path / "outputs")
    copied = tmp_path / "outputs" / "sweeps" / folder.name
    for run in (tmp_path / "outputs" / "runs").iterdir():
        if "gravity: 9.7\n" in (run / "config.yaml").read_text():
            shutil.rmtree(run)
    out = cli("compare", copied, "--by", "controller").out
    assert "not stored, so that none has gravity=9.7; what follows holds for the others; continue with" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("--by", "controler"),
            "--by: unknown axis 'controler'. Allowed: controller, gravity. Did you mean 'controller'?",
        ),
        (("--by", "controller", "--within", "robot"), "--within: unknown axis 'robot'"),
        (("--by", "controller", "--metrics", "torque"), "unknown metric 'torque'"),
        (("--within", "controller"), "within: controller is the compared axis"),
    ],
)
def test_bad_arguments_are_refused_in_a_line(cli, folder, arguments, message):
    ending = cli("compare", folder, *arguments)
    assert (ending.code, ending.out) == (2, "")
    assert message in ending.err
    assert ending.err.count("\n") == 1


def test_the_question_is_the_law_and_by_asks_another_which_is_kept(cli, folder, tmp_path):
    copied = tmp_path / "outputs" / "sweeps" / folder.name
    shutil.copytree(folder.parent.parent, tmp_path / "outputs")
    (copied / "question.json").unlink(missing_ok=True)  # of another test
    assert "; by controller\n" in cli("compare", copied).out
    assert not (copied / "question.json").exists()
    assert "; by gravity\n" in cli("compare", copied, "--by", "gravity").out
    assert "; by gravity\n" in cli("compare", copied).out
    opened = runner.open_sweep(copied)
    assert set(opened.compare(metrics="rms_torque")["first"]) == {"9.7"}
    assert "gravity=9.7" in cli("results", tmp_path / "outputs").out
    page = cli("report", copied, "--format", "html").folder.joinpath("report.html")
    assert "<h1>What gravity changes, over controller</h1>" in page.read_text()
    page = cli("report", copied, "--format", "html", "--by", "controller").folder.joinpath("report.html")
    assert "<h1>Which controller: computed_torque or operational_space, over gravity?</h1>" in page.read_text()
    assert cli("verify", tmp_path / "outputs").code == 0
    bad = cli("report", copied, "--by", "controler")
    assert (bad.code, bad.out) == (2, "")
    assert "--by: unknown axis 'controler'. Allowed: controller, gravity." in bad.err


def test_a_sweep_over_conditions_needs_by(cli):
    ending = cli("compare", cli("-m", *TASK, "gravity=9.81,9.7").folder)
    assert (ending.code, ending.out) == (2, "")
    assert "only one sweep, over conditions only. Add a second one, or compare the levels of an axis" in ending.err


def test_by_is_for_one_sweep(cli, folder):
    assert (
        "--by: not for these results. Allowed: only for one sweep."
        in cli("compare", folder, folder, "--by", "controller").err
    )


def test_where_limits_the_cells(cli, folder):
    both = ("--by", "controller", "--metrics", "rms_torque", "--all")
    ending = cli("compare", folder, *both, "--where", "gravity=9.81")
    assert "2 cells; repetitions in each: 8; by controller" in ending.out
    assert len(rows(ending.out, "rms_torque")) == 1
    assert "--where gravity: no value. Allowed: KEY=VALUE." in cli("compare", folder, *both, "--where", "gravity").err


def test_each_of_several_axes_is_compared(cli, folder):
    out = cli("compare", folder, "--by", "controller,gravity", "--metrics", "rms_torque").out
    heads = [line for line in out.splitlines() if "; by " in line]
    assert [head.partition("; by ")[2] for head in heads] == ["controller", "gravity"]


def test_an_axis_whose_cells_are_gone_is_not_called_unknown():
    sweep = SimpleNamespace(folder="s", overrides=[["controller=a"], ["controller=b"]])
    stored = SimpleNamespace(axes=[], hashes=["1"], command="runner -m controller=a,b")
    with pytest.raises(RunnerError, match=r"s: 1 of 2 cells can be read, with one value of controller: nothing to"):
        _check_levels(sweep, stored, "controller")
    _check_levels(sweep, stored, "robot")
