"""A whole sweep as a baseline: saved, and compared cell by cell."""

import pytest
import yaml

import runner
from runner.base.machine import this_machine

SWEEP = ("-m", "hydra.sweeper.workers=0", "robot=macro", "duration=0.3", "noise=thesis", "trajectory=quintic")
AXIS = "controller.natural_frequency=20,30"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Outputs for all tests: the sweep that is learned is made once."""
    return f"outputs={tmp_path_factory.mktemp('learned')}"


@pytest.fixture
def learned(cli, outputs, tmp_path):
    folder = cli(*SWEEP, outputs, AXIS, "repetitions=5").folder
    path = tmp_path / "baseline.yaml"
    ending = cli("check", folder, "--save-baseline", path)
    assert ending.code == 0
    assert ending.out == f"saved: {_count(path)} metrics of {folder} in {path}\n"
    return folder, path


def _count(path):
    return sum(len(cell["metrics"]) for cell in yaml.safe_load(path.read_text())["cells"].values())


def change(path, cell, metric, **values):
    """Change a metric of a cell, as if another run had been saved."""

    def change_cell(content):
        content["cells"][cell]["run"] = "0" * 24
        content["cells"][cell]["metrics"][metric] |= values

    edit(path, change_cell)


def edit(path, function):
    content = yaml.safe_load(path.read_text())
    function(content)
    path.write_text(yaml.safe_dump(content))


def test_a_sweep_is_good_against_what_it_taught(cli, learned):
    folder, path = learned
    for flags in ((), ("--format", "markdown"), ("--format", "text")):
        ending = cli("check", folder, "--baseline", path, *flags)
        assert (ending.code, ending.err) == (0, "")
        assert f"{_count(path)} metrics of 2 cells: 0 moved, 0 beyond the seeds' spread" in ending.out
        assert ending.out.count("\n") == 1


def test_other_seeds_move_within_the_spread(cli, outputs, learned):
    other = cli(*SWEEP, outputs, AXIS, "repetitions=5", "seed=1").folder
    ending = cli("check", other, "--baseline", learned[1])
    assert " 0 moved" not in ending.out
    moved = [line.split() for line in ending.out.splitlines()[2:]]
    assert {"up", "down"} & {word for line in moved for word in line}
    assert any(line[-1] == "no" for line in moved)


def test_what_moved_is_told_with_direction_and_spread(cli, learned):
    folder, path = learned
    cells = yaml.safe_load(path.read_text())["cells"]
    cell = "controller.natural_frequency=20"
    peak, energy = (cells[cell]["metrics"][name]["median"] for name in ("peak_torque", "energy"))
    change(path, cell, "peak_torque", median=peak / 2, min=peak / 2, max=peak / 2)
    change(path, cell, "energy", median=energy * 2, min=energy / 2, max=energy * 3)
    ending = cli("check", folder, "--baseline", path, "--format", "markdown")
    assert ending.code == 1
    head, blank, titles, rule, *rows = ending.out.splitlines()
    assert head.endswith("2 moved, 1 beyond the seeds' spread**")
    assert (blank, titles) == ("", "| cell | metric | was | is | moved | beyond the seeds' spread |")
    assert rule == "| --- | --- | ---: | ---: | ---: | --- |"
    table = {row.split(" | ")[1]: row.strip("| ").split(" | ") for row in rows}
    assert table["peak_torque"][0] == cell
    assert table["peak_torque"][4:] == ["up 1e+02 %", "yes"]
    assert table["energy"][4:] == ["down 50 %", "no"]
    assert table["energy"][2].endswith(" J")


def test_a_metric_without_value_is_beyond_every_number(cli, learned):
    folder, path = learned
    change(path, "controller.natural_frequency=30", "settling_time", median=None, min=None, max=None)
    change(path, "controller.natural_frequency=20", "peak_torque", median=None, min=0.0, max=None)
    ending = cli("check", folder, "--baseline", path)
    rows = {line.split()[0] + line.split()[1]: line.split() for line in ending.out.splitlines()[2:]}
    assert "down" in rows["controller.natural_frequency=20peak_torque"]
    assert rows["controller.natural_frequency=20peak_torque"][-1] == "no"


def test_cells_that_are_new_gone_or_failed_are_told(cli, outputs, learned):
    other = cli(*SWEEP, outputs, "controller.natural_frequency=20,40", "repetitions=5").folder
    ending = cli("check", other, "--baseline", learned[1])
    assert ending.code == 1
    lines = [" ".join(line.split()) for line in ending.out.splitlines()]
    assert "controller.natural_frequency=40 (all) is new no" in lines
    assert "controller.natural_frequency=30 (all) is gone yes" in lines
    failing = ("plant=rk4", "controller.period=0.06", "controller.singularity_damping=0", "duration=2")
    failed = cli(*SWEEP, outputs, AXIS, "repetitions=5", *failing).folder
    ending = cli("check", failed, "--baseline", learned[1])
    assert ending.code == 1
    assert "diverged" in ending.out
    assert "a failed run cannot be in a baseline" in cli("check", failed, "--save-baseline", learned[1]).err


CELL = "controller.natural_frequency=20"


def move(share, **more):
    """Return an edit that moves a metric of a cell by a share, whose seeds then agree."""

    def change_content(content):
        for machine in content["machines"].values():
            machine |= more.get("machine", {})
        for versions in content["versions"].values():
            versions |= more.get("versions", {})
        metric = content["cells"][CELL]["metrics"]["energy"]
        value = metric["median"] * (1 + share)
        metric |= {"median": value, "min": value, "max": value} | more.get("metric", {})

    return change_content


def test_a_baseline_keeps_the_run_the_machine_and_the_versions_of_each_cell(learned):
    folder, path = learned
    content = yaml.safe_load(path.read_text())
    runs = runner.open_sweep(folder).runs()
    assert content["schema"] == 2
    for cell, run in zip(content["cells"].values(), runs, strict=True):
        assert cell["run"] == run.hash
        assert content["machines"][cell["machine"]] == run.provenance["machine"]
        assert content["versions"][cell["versions"]] == run.provenance["versions"]
    assert len(content["machines"]) == len(content["versions"]) == 1


OTHER_CORE = {"machine": {"openblas": "Prescott"}}


@pytest.mark.parametrize(
    ("change_content", "code", "expected"),
    [
        (move(1e-9), 1, "not reproducible here"),
        (move(1e-9, **OTHER_CORE), 0, "2 cells: the baseline is of another machine"),
        (move(1e-3, **OTHER_CORE), 1, "yes, rounding or a library"),
        (move(1e-3, **OTHER_CORE, metric={"min": 0.0}), 0, "no, rounding or a library"),
        (move(-1e-3, **OTHER_CORE, metric={"max": 1e3}), 0, "no, rounding or a library"),
        (move(1e-3, **OTHER_CORE, metric={"sensitive": 0.1}), 0, "yes, sensitive to rounding"),
        (move(1e-3, **OTHER_CORE, metric={"sensitive": 1e-9}), 1, "yes, rounding or a library"),
        (move(1e-3, metric={"sensitive": 0.1}), 1, "not reproducible here"),
        (move(1e-3, versions={"numpy": "1.0"}), 1, "yes, rounding or a library"),
        (
            move(1e-9, versions={"numpy": "1.0"}),
            0,
            "of other library versions, which may round differently: numpy 1.0 a",
        ),
    ],
)
def test_a_run_of_the_same_name_moves_by_rounding_a_library_or_not_at_all(cli, learned, change_content, code, expected):
    folder, path = learned
    edit(path, change_content)
    ending = cli("check", folder, "--baseline", path)
    assert (ending.code, ending.err) == (code, "")
    assert expected in ending.out


def test_both_machines_are_named_where_rounding_moves_a_metric(cli, learned):
    folder, path = learned
    edit(path, move(1e-3, **OTHER_CORE))
    expected = cli("check", folder, "--baseline", path, "--format", "markdown").out.splitlines()[-1]
    assert expected == (
        "2 cells: the baseline is of another machine, which may round differently: OpenBLAS Prescott against OpenBLAS "
        f"{this_machine().openblas} here"
    )


def without(key, value=None):
    def change_content(content):
        for cell in content["cells"].values():
            cell[key] = value

    return change_content


def former(content):
    content["schema"] = 1
    content["cells"] = {name: cell["metrics"] for name, cell in content["cells"].items()}
    del content["machines"], content["versions"]


@pytest.mark.parametrize(
    ("change_content", "expected"),
    [
        (former, "2 cells: the baseline names no run, so rounding is not distinguished"),
        (without("run"), "2 cells: the baseline names no run, so rounding is not distinguished"),
        (without("machine"), "2 cells: the baseline or the run does not name machine and versions"),
        (without("versions"), "2 cells: the baseline or the run does not name machine and versions"),
        (without("versions", "v9"), "2 cells: the baseline or the run does not name machine and versions"),
    ],
)
def test_a_baseline_that_does_not_name_what_made_it_is_checked_and_says_so(cli, learned, change_content, expected):
    folder, path = learned
    edit(path, change_content)
    ending = cli("check", folder, "--baseline", path)
    assert (ending.code, ending.err) == (0, "")
    first, sentence = ending.out.splitlines()
    assert first.startswith("good: ")
    assert sentence.startswith(expected)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            "schema: 3\ncells: {a: {metrics: {energy: {unit: J, median: 1.0, min: 1.0, max: 1.0, seeds: 1}}}}",
            "schema: must be 1 or 2; found 3",
        ),
        ("schema: 2\ncells: {a: {energy: {unit: J, median: 1.0}}}", "cells.a.metrics: missing"),
        ("schema: 1\ncells: {}", "cells: must have at least one metric"),
        (
            "schema: 1\ncells: {a: {energy: {unit: J, median: x, min: 1.0, max: 1.0, seeds: 1}}}",
            "cells.a.energy.median",
        ),
        ("schema: [", "baseline.yaml, line 2"),
    ],
)
def test_a_damaged_reference_is_said(cli, learned, content, message):
    folder, path = learned
    path.write_text(content)
    ending = cli("check", folder, "--baseline", path)
    assert (ending.code, ending.out) == (2, "")
    assert message in ending.err


def test_markdown_is_for_sweeps(cli, learned):
    folder, path = learned
    path.write_text("schema: 1\nmetrics: {peak_torque: {min: 0.0, reason: no sign}}\n")
    ending = cli("check", folder, "--baseline", path, "--format", "markdown")
    assert ending.code == 2
    assert "--format markdown: only for the baseline of a sweep" in ending.err


def test_a_file_of_bands_keeps_its_metrics_and_holds_the_seeds(cli, outputs, tmp_path):
    sweep = cli(*SWEEP, outputs, "seed=0,1", "repetitions=5").folder
    path = tmp_path / "bands.yaml"
    path.write_text("# Own\nschema: 1\nmetrics:\n  energy: {min: 0, max: 1e-3, reason: the move}\n")
    assert cli("check", sweep, "--baseline", path).code == 1
    assert cli("check", sweep, "--save-baseline", path).out == f"saved: 1 metric of {sweep} in {path}\n"
    assert cli("check", sweep, "--baseline", path).code == 0
    (name,) = yaml.safe_load(path.read_text())["metrics"]
    assert name == "energy"
    other = cli(*SWEEP, outputs, AXIS, "repetitions=5").folder
    ending = cli("check", other, "--save-baseline", path)
    assert (ending.code, ending.err.count("two or more seeds")) == (2, 1)
