"""Settings of a config file: keys on simulation, code and folders are refused before anything runs."""

import json
import os
import socket
from pathlib import Path

import hydra
import pytest
from support.opened_files import opened

from runner.base.errors import ConfigError
from runner.base.paths import conf_dir
from runner.config.compose.compose import compose

HEAD = "# @package _global_\n# A stranger's\n# experiment\n"
OURS, HYDRAS = conf_dir(), Path(hydra.__file__).parent / "conf"
WHY = "controls how or where runs are simulated, which no file may do; set it on the command line or in "


@pytest.fixture
def stranger(cli, tmp_path):
    """Run a file of a third-party config folder, once or as a sweep; it may create the folder `done`."""

    def run(text, *mode, file="experiment/trap", head=HEAD):
        place = tmp_path / "theirs" / f"{file}.yaml"
        place.parent.mkdir(parents=True, exist_ok=True)
        made = json.dumps({"_target_": "os.mkdir", "path": str(tmp_path / "done")})
        place.write_text(head + text.replace("MAKE", made))
        group, _, option = file.partition("/")
        chosen = [f"{group}={option}"] if option else ["--config-name", file]
        ending = cli(*mode, "--config-dir", "theirs", *chosen, "robot=macro", "plant=rk4", "duration=0.05")
        assert not (tmp_path / "done").exists()
        return ending

    return run


@pytest.fixture
def listening():
    """A port of this machine at which no client came, once the test has ended."""
    with socket.create_server(("127.0.0.1", 0)) as door:
        yield door.getsockname()[1]
        door.setblocking(False)
        with pytest.raises(BlockingIOError):
            door.accept()


HOW = [
    ("hydra: {callbacks: {a: MAKE}}", "hydra.callbacks.a._target_"),
    ("hydra: {sweeper: {_recursive_: true}}", "hydra.sweeper._recursive_"),
    ("hydra: {sweeper: {workers: 3}}", "hydra.sweeper.workers"),
    ("hydra: {job_logging: {root: {handlers: [a]}}}", "hydra.job_logging.root.handlers"),
    ("hydra: {job: {env_set: {RUNNER_PLUGINS: metric=trap.py}}}", "hydra.job.env_set.RUNNER_PLUGINS"),
    ("hydra: {job: {env_copy: [PATH]}}", "hydra.job.env_copy"),
    ("hydra: {run: {dir: there}}", "hydra.run.dir"),
    ("hydra: {mode: MULTIRUN}", "hydra.mode"),
    ("hydra: 3", "hydra"),
    ("outputs: there", "outputs"),
    ("defaults: [override hydra/sweeper: basic]", "hydra/sweeper"),
    ("defaults: [/hydra/job_logging/default]", "hydra/job_logging/default"),
    ("defaults: ['/noise@hydra.callbacks': thesis]", "noise@hydra.callbacks"),
]


@pytest.mark.parametrize(("text", "key"), HOW)
@pytest.mark.parametrize("mode", [(), pytest.param(("-m",), marks=pytest.mark.slow)])
def test_how_and_where_runs_are_made_is_not_set_by_a_file(stranger, tmp_path, text, key, mode):
    ending = stranger(text, *mode)
    assert (ending.code, ending.out) == (2, "")
    assert f"theirs/experiment/trap.yaml, line 4: '{key}' {WHY}" in ending.err
    assert "arm-control-runner/config.yaml; allowed here: keys of hydra.sweeper.params" in ending.err
    assert [entry.name for entry in tmp_path.iterdir()] == ["theirs"]


def test_a_scheduler_that_a_file_names_is_not_called(stranger, listening):
    ending = stranger(f"hydra:\n  sweeper:\n    address: tcp://127.0.0.1:{listening}", "-m")
    assert (ending.code, ending.out) == (2, "")
    assert f"theirs/experiment/trap.yaml, line 6: 'hydra.sweeper.address' {WHY}" in ending.err


@pytest.mark.parametrize(
    ("head", "text", "key"),
    [
        ("# @package hydra.sweeper\n", "address: ADDRESS", "hydra.sweeper.address"),
        ("# @package _global_.hydra\n", "sweeper: {address: ADDRESS}", "hydra.sweeper.address"),
        ("# @package _global_\n", "defaults: ['other@hydra.sweeper']\naddress: ADDRESS", "other@hydra.sweeper"),
        ("# @package x_global_.hydra.sweeper\n", "address: ADDRESS", "hydra.sweeper.address"),
        ("# @package x\n", "defaults: ['other@x_global_.hydra']", "other@x_global_.hydra"),
    ],
)
def test_nor_by_way_of_a_package(stranger, listening, head, text, key):
    ending = stranger(text.replace("ADDRESS", f"tcp://127.0.0.1:{listening}"), "-m", file="noise/hydra", head=head)
    assert (ending.code, ending.out) == (2, "")
    assert f"theirs/noise/hydra.yaml, line 2: '{key}' {WHY}" in ending.err


def test_nor_by_way_of_a_group(stranger, listening, tmp_path):
    inner = tmp_path / "theirs/experiment/x_global_.hydra/sweeper.yaml"
    inner.parent.mkdir(parents=True)
    inner.write_text(f"address: tcp://127.0.0.1:{listening}\n")
    ending = stranger("defaults: [x_global_.hydra/sweeper]", "-m")
    assert (ending.code, ending.out) == (2, "")
    assert f"sweeper.yaml: 'experiment/x_global_.hydra/sweeper' {WHY}" in ending.err


def test_code_as_a_value_of_ours_is_only_a_wrong_value(stranger):
    ending = stranger("seed: MAKE")
    assert ending.code == 2
    assert "seed: must be a whole number" in ending.err


def test_axes_of_an_experiment_stay_free(stranger):
    ending = stranger("hydra: {sweeper: {params: {seed: '0,1'}}}", "-m", "hydra.sweeper.workers=0")
    assert ending.code == 0
    assert "runner: 2 runs" in ending.err


@pytest.mark.parametrize(
    ("params", "problem"),
    [
        ("3", "line 6: 'hydra.sweeper.params' controls how"),
        ("${x}\nx: {outputs: there}", "line 6: 'hydra.sweeper.params' controls how"),
        ("{seed: MAKE}", "seed: must be a whole number"),
        ("{seed: '${nope}'}", "hydra.sweeper.params.seed: it refers to nope"),
        (
            "{hydra.sweeper.address: 'tcp://127.0.0.1:9'}",
            "line 6: 'hydra.sweeper.params.hydra.sweeper.address' controls how",
        ),
        ("{outputs: there}", "line 6: 'hydra.sweeper.params.outputs' controls how"),
        ("{++outputs: there}", "line 6: 'hydra.sweeper.params.++outputs' controls how"),
        ("{'noise@hydra.sweeper': none}", "'hydra.sweeper.params.noise@hydra.sweeper' controls how"),
        ("{robot.name: '${x}{oc.env:HOME}'}\nx: $", "'robot.name=${oc.env:HOME}' calls a function"),
    ],
)
def test_axes_of_an_experiment_are_values(stranger, params, problem):
    text = f"hydra:\n  sweeper:\n    params: {params}"
    ending = stranger(text, "-m", "hydra.sweeper.workers=0")
    assert (ending.code, ending.out) == (2, "")
    assert problem in ending.err


@pytest.fixture
def trap(tmp_path, monkeypatch):
    """A module that makes the file `done` when it is imported."""
    folder = tmp_path / "modules"
    folder.mkdir()
    (folder / "trap_module.py").write_text(f"open({str(tmp_path / 'done')!r}, 'w')")
    monkeypatch.syspath_prepend(folder)
    yield "trap_module"
    assert not (tmp_path / "done").exists()


@pytest.mark.parametrize(
    "command",
    [
        ("robot=macro",),
        ("-m", "robot=macro", "seed=1,2"),
        ("tune", "controller.natural_frequency=interval(5,10)", "--minimize", "energy"),
        ("calibrate",),
    ],
)
def test_a_search_path_is_given_by_config_dir_alone(cli, trap, command):
    ending = cli(*command, f"hydra.searchpath=[pkg://{trap}]")
    assert (ending.code, ending.out) == (2, "")
    assert "hydra.searchpath: is Hydra's own; you may set" in ending.err
    assert "folders: --config-dir" in ending.err


@pytest.mark.parametrize("scheme", ["pkg", "structured", "file"])
def test_nor_does_a_primary_config_name_one(stranger, trap, scheme):
    ending = stranger(f"hydra: {{searchpath: ['{scheme}://{trap}']}}", file="mine")
    assert ending.code == 2
    assert f"theirs/mine.yaml, line 4: 'hydra.searchpath' {WHY}" in ending.err


def test_nor_does_python(trap):
    with pytest.raises(ConfigError, match=r"hydra\.searchpath: is Hydra's own"):
        compose([f"hydra.searchpath=[pkg://{trap}]"])


def test_several_config_folders_are_searched(cli, tmp_path):
    for folder, name in (("a", "noise"), ("b", "trajectory")):
        (tmp_path / folder / name).mkdir(parents=True)
    (tmp_path / "a/noise/mine.yaml").write_text("defaults: [thesis]\nposition: 1e-3\n")
    (tmp_path / "b/trajectory/mine.yaml").write_text("defaults: [goal]\n")
    line = ("robot=macro", "noise=mine", "trajectory=mine", "plant=rk4", "duration=0.05")
    assert cli("--config-dir", "a", "--config-dir=b", *line).code == 0


def test_the_environment_enters_by_no_file_and_no_override(cli, stranger, monkeypatch):
    monkeypatch.setenv("RUNNER_SECRET", "hidden")
    ending = stranger("robot: {name: '${oc.env:RUNNER_SECRET}'}")
    assert ending.code == 2
    assert "trap.yaml, line 4: '${oc.env:RUNNER_SECRET}' calls a function; a file may only refer to keys" in ending.err
    ending = cli("robot.name=${oc.env:RUNNER_SECRET}", "duration=0.05")
    assert ending.code == 2
    assert "'robot.name=${oc.env:RUNNER_SECRET}' calls a function; a value may only refer to keys" in ending.err
    assert "hidden" not in ending.err


@pytest.mark.parametrize(
    ("entry", "root"),
    [
        ("/HERE/secret", OURS),
        ("UP/secret", OURS),
        ("UP/secret", HYDRAS),
        ("{/noise: UP/secret}", HYDRAS),
        ("{/noise: '${experiment}/../UP/secret'}", OURS),
        ("'/UP/secret@_here_'", HYDRAS),
    ],
)
def test_a_config_outside_of_every_folder_is_refused(stranger, tmp_path, entry, root):
    secret = tmp_path / "secret.yaml"
    secret.write_text("# @package _global_\nhydra: {sweeper: {address: 'tcp://127.0.0.1:9'}}\n")
    up = os.path.relpath(tmp_path, root / "experiment")
    text = f"defaults: [{entry}]".replace("HERE", str(tmp_path)).replace("UP", up)
    with opened() as seen:
        ending = stranger(text, "-m")
    assert (ending.code, ending.out) == (2, "")
    assert str(secret) not in seen
    assert "not a config in a folder" in ending.err


@pytest.mark.parametrize("value", ["../../secret", "a/../b"])
def test_nor_does_an_override_name_one(cli, value):
    ending = cli("robot=macro", f"noise={value}")
    assert (ending.code, ending.out) == (2, "")
    assert f"{value}': not a config in a folder" in ending.err


@pytest.mark.parametrize("file", ["experiment/trap.yaml", "noise", "robots/own.urdf", "own.csv"])
def test_links_out_of_a_config_folder_are_refused(cli, tmp_path, file):
    folder = tmp_path / "theirs"
    (tmp_path / "away/noise").mkdir(parents=True)
    contents = {"away/trap.yaml": HEAD, "away/noise/mine.yaml": "defaults: [thesis]\n", "away/own.urdf": "<robot/>"}
    for name, content in (contents | {"away/own.csv": "t\n"}).items():
        (tmp_path / name).write_text(content)
    place = folder / file
    place.parent.mkdir(parents=True)
    place.symlink_to(tmp_path / "away" / place.name)
    line = {
        "experiment/trap.yaml": ["experiment=trap"],
        "noise": ["noise=mine"],
        "robots/own.urdf": ["robot.urdf=own.urdf"],
        "own.csv": ["trajectory=from_file", "trajectory.file=own.csv"],
    }[file]
    ending = cli("--config-dir", folder, "robot=macro", *line)
    assert (ending.code, ending.out) == (2, "")
    assert f"outside of the folder {folder}; put the file itself there" in ending.err
    place.unlink()
    place.symlink_to(os.devnull)


@pytest.mark.parametrize("params", ["3", "[seed]"])
def test_axes_that_are_typed_are_keys(cli, params):
    ending = cli("-m", "robot=macro", f"hydra.sweeper.params={params}")
    assert ending.code == 2
    assert "hydra.sweeper.params: must be keys with their values, or null; found" in ending.err


@pytest.mark.parametrize("address", ["3", "[a]", "true"])
def test_an_address_is_a_text(cli, address):
    ending = cli("-m", "robot=macro", "seed=1,2", f"hydra.sweeper.address={address}")
    assert ending.code == 2
    assert "hydra.sweeper.address: must be that of a Dask scheduler, as tcp://127.0.0.1:8786, or null" in ending.err


def test_files_without_end_are_not_read(cli, tmp_path):
    (tmp_path / "experiment").mkdir()
    (tmp_path / "experiment/zero.yaml").symlink_to("/dev/zero")
    with (tmp_path / "experiment/big.yaml").open("wb") as file:
        file.truncate(10**12)
    for name, told in (
        ("zero", "experiment: no 'zero'"),
        ("big", "big.yaml: has 1,000,000,000,000 bytes; allowed: up"),
    ):
        ending = cli("--config-dir", tmp_path, f"experiment={name}", "robot=macro")
        assert ending.code == 2
        assert told in ending.err
