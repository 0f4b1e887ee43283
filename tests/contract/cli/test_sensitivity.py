"""`runner sensitivity`: tables, the check, and what it refuses."""

from dataclasses import replace

import pytest

import runner
from runner import store
from runner.analysis import GROUPS, of_run
from runner.base.errors import RunnerError

MACRO = ("robot=macro", "plant=rk4", "trajectory=quintic", "duration=0.05")


@pytest.fixture
def run(copy_run):
    return copy_run("rk4")


def test_a_table_for_each_metric_the_largest_first(cli, run):
    ending = cli("sensitivity", run, "--metrics", "peak_torque,energy", "--parameters", "masses,gains")
    assert (ending.code, ending.err) == (0, "")
    head, *tables, beside = ending.out.split("\n\n")
    assert head == "macro, operational_space, repetition 0\nheld: the start, the desired motion, the ticks"
    assert [table.split(":")[0] for table in tables] == ["peak_torque", "energy"]
    rows = [line.split() for line in tables[0].splitlines()[2:]]
    assert {row[0] for row in rows} == {
        "mass.q2", "mass.q3", "controller.natural_frequency", "controller.damping_ratio",
        "controller.singularity_damping",
    }  # fmt: skip
    sizes = [abs(float(row[-1])) for row in rows]
    assert sizes == sorted(sizes, reverse=True)
    assert beside.splitlines()[:2] == [
        "controller.natural_frequency also changes controller.null_space_frequency",
        "not in the tables: controller.period: it changes the ticks or steps of the run, which are held",
    ]


def test_differences_stand_beside_where_they_are_asked_for(cli, run):
    ending = cli("sensitivity", run, "--metrics", "rms_tracking_error", "--parameters", "gains", "--finite-differences")
    assert ending.code == 0
    *_, count, gap = ending.out.splitlines()
    assert count.endswith("central differences are sure to 1e-07 of the derivative or better")
    assert gap.startswith("largest gap among these:")
    assert gap.endswith("within 1e-06")


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("settling_time", "settling_time has no derivative: it jumps from one tick to another, and stays in between"),
        ("saturation_fraction_q1", "saturation_fraction_q1 has no derivative: it counts ticks"),
        ("peak_torq", "unknown metric with a derivative 'peak_torq'"),
    ],
)
def test_a_metric_without_derivative_is_not_approximated(cli, run, name, why):
    ending = cli("sensitivity", run, "--metrics", name, "--parameters", "gains")
    assert ending.code == 2
    assert f"--metrics: {why}" in ending.err
    assert "Allowed: " in ending.err
    assert "rms_tracking_error" in ending.err


@pytest.mark.parametrize(
    ("made", "why"),
    [
        ("contact", "controller admittance commands joint positions"),
        ("flexible", "plant.flexible_joints: runs of arms with flexible joints"),
        ((*MACRO, "noise.resolution=1e-3"), "noise.resolution rounds the measured positions"),
        ((*MACRO, "environment=push"), "environment push: runs in which the tip feels something"),
        ((*MACRO, "plant=rk4_flexible_links"), "plant.links: runs of arms whose links bend"),
    ],
)
def test_runs_without_derivatives_are_refused_with_the_reason(cli, copy_run, made, why):
    ending = cli("sensitivity", copy_run(made) if isinstance(made, str) else cli(*made).folder)
    assert ending.code == 2
    assert f"no derivatives of this run: {why}" in ending.err


def test_a_run_on_another_plant_has_those_of_its_counterpart(cli, copy_run, run):
    one = ("--metrics", "peak_torque", "--parameters", "masses")
    other = copy_run("mujoco")
    told, same = cli("sensitivity", other, *one).out, cli("sensitivity", run, *one).out
    assert "derivatives of the same run on rk4, because those of mujoco are not available" in told
    assert told.split("\n\n")[1] == same.split("\n\n")[1]


def test_a_run_that_its_command_no_longer_gives_is_refused(run):
    stored = store.open_run(run)
    other = replace(stored, config={**stored.config, "gravity": 9.0, "duration": 9.0})
    with pytest.raises(RunnerError, match="gives another duration, gravity today; rerun it"):
        of_run(other)


def test_bad_arguments(cli, run):
    assert "--parameters: unknown name 'mases'" in cli("sensitivity", run, "--parameters", "mases").err
    ending = cli("sensitivity", run, "--repetition", 40)
    assert (ending.code, "has no repetition 40" in ending.err, "Allowed: 0 to 39" in ending.err) == (2, True, True)
    told = "depends on no parameter of payload; robot.payload.mass: its value is 0 (a small value shows its effect)"
    assert told in cli("sensitivity", run, "--parameters", "payload").err


def test_another_repetition_has_its_own_noise(cli, run):
    asked = ("sensitivity", run, "--metrics", "max_tracking_error", "--parameters", "noise")
    first, second = (cli(*asked, "--repetition", number).out.split("\n\n")[1] for number in (0, 1))
    assert first != second


def test_from_python_it_is_arrays(run):
    found = runner.open_run(run).sensitivity("masses")
    assert found.derivatives["peak_torque"].shape == (2,)
    assert [parameter.name for parameter in found.parameters] == ["mass.q2", "mass.q3"]


def test_the_command_names_all_groups(cli, capsys):
    with pytest.raises(SystemExit, match="0"):
        cli("sensitivity", "--help")
    assert f"groups of parameters: {', '.join(GROUPS)} (default: all)" in " ".join(capsys.readouterr().out.split())
