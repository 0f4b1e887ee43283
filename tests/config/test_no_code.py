"""Configs that name code: refused from every kind of file, before anything runs."""

import json
import os

import pytest
from hydra._internal.config_search_path_impl import ConfigSearchPathImpl

from runner.config.compose import compose
from runner.config.no_code import refuse_modules
from runner.errors import ConfigError
from runner.paths import conf_dir

HEAD = "# @package _global_\n# A stranger's\n# experiment\n"


@pytest.fixture
def stranger(cli, tmp_path):
    """Runs an experiment of a stranger's config folder, whose text may make the folder `done`, once or as a sweep."""

    def run(text, *mode):
        folder = tmp_path / "theirs"
        (folder / "experiment").mkdir(parents=True)
        made = json.dumps({"_target_": "os.mkdir", "path": str(tmp_path / "done")})
        (folder / "experiment/trap.yaml").write_text(HEAD + text.replace("MAKE", made))
        ending = cli(*mode, "--config-dir", folder, "experiment=trap", "robot=macro", "plant=rk4", "duration=0.05")
        assert not (tmp_path / "done").exists()
        return ending

    return run


CODE = [
    ("hydra: {callbacks: {a: MAKE}}", "callbacks"),
    ("hydra: {sweeper: {params: {seed: MAKE}}}", "sweeper"),
    ("hydra: {sweeper: {_recursive_: true}}", "sweeper"),
    ("hydra: {job_logging: {handlers: {a: {'()': os.mkdir, path: done}}, root: {handlers: [a]}}}", "job_logging"),
    ("hydra: {hydra_logging: {formatters: {a: {'()': os.getcwd}}}}", "hydra_logging"),
    ("hydra: {job: {env_set: {RUNNER_PLUGINS: metric=trap.py}}}", "job.env_set"),
    ("hydra: {job: {env_copy: [PATH]}}", "job.env_set"),
    ("hydra: {sweeper: {params: {robot.name: '${x}{oc.env:HOME}'}}}\nx: $", "sweeper"),
]
# Both modes compose alike: what concerns the sweeper is tried as a sweep, the rest as a run; the other half is slow.
MODES = [
    pytest.param(text, key, mode, marks=() if (key == "sweeper") == (mode == ("-m",)) else pytest.mark.slow)
    for text, key in CODE
    for mode in ((), ("-m",))
]


@pytest.mark.parametrize(("text", "key", "mode"), MODES)
def test_a_config_that_names_code_is_refused_before_it_runs(stranger, text, key, mode):
    ending = stranger(text, *mode)
    assert (ending.code, ending.out) == (2, "")
    assert f"hydra.{key}: a config cannot name code" in ending.err


def test_code_as_a_value_of_ours_is_only_a_wrong_value(stranger):
    ending = stranger("seed: MAKE")
    assert ending.code == 2
    assert "seed: must be a whole number" in ending.err


def test_axes_of_an_experiment_stay_free(stranger):
    ending = stranger("hydra: {sweeper: {workers: 0, params: {seed: '0,1'}}}", "-m")
    assert ending.code == 0
    assert "runner: 2 runs" in ending.err


@pytest.fixture
def trap(tmp_path, monkeypatch):
    """A module that makes the file `done` when it is imported."""
    folder = tmp_path / "modules"
    folder.mkdir()
    (folder / "trap_module.py").write_text(f"open({str(tmp_path / 'done')!r}, 'w')")
    monkeypatch.syspath_prepend(folder)
    yield "trap_module"
    assert not (tmp_path / "done").exists()


@pytest.mark.parametrize("scheme", ["pkg", "structured"])
@pytest.mark.parametrize(
    "command",
    [
        ("robot=macro",),
        ("-m", "robot=macro", "seed=1,2"),
        ("tune", "controller.natural_frequency=interval(5,10)", "--minimize", "energy"),
        ("calibrate",),
    ],
)
def test_a_search_path_imports_nothing(cli, trap, command, scheme):
    ending = cli(*command, f"hydra.searchpath=[{scheme}://{trap}]")
    assert (ending.code, ending.out) == (2, "")
    assert f"hydra.searchpath: '{scheme}://{trap}' names a module; allowed: folders" in ending.err


@pytest.mark.parametrize("scheme", ["pkg", "structured"])
def test_nor_does_that_of_a_stranger_s_primary_config(cli, trap, tmp_path, scheme):
    own = tmp_path / "theirs"
    own.mkdir()
    (own / "mine.yaml").write_text(f"hydra: {{searchpath: ['{scheme}://{trap}']}}\n")
    ending = cli("--config-dir", own, "--config-name", "mine", "robot=macro")
    assert ending.code == 2
    assert f"hydra.searchpath: '{scheme}://{trap}' names a module" in ending.err


@pytest.mark.parametrize(
    ("text", "key"),
    [("output_subdir: there", "output_subdir"), ("run: {dir: there}", "run.dir"), ("job: {chdir: true}", "job.chdir")],
)
def test_a_primary_config_does_not_say_where_hydra_writes(cli, tmp_path, text, key):
    own = tmp_path / "theirs"
    own.mkdir()
    (own / "mine.yaml").write_text(f"defaults: [config, _self_]\nhydra: {{{text}}}\n")
    ending = cli("--config-dir", own, "--config-name", "mine", "robot=macro")
    assert ending.code == 2
    assert f"hydra.{key}: a config cannot name code" in ending.err
    assert [entry.name for entry in tmp_path.iterdir()] == ["theirs"]


def test_nor_does_python(trap):
    with pytest.raises(ConfigError, match=r"hydra\.searchpath: 'pkg://"):
        compose([f"hydra.searchpath=[pkg://{trap}]"])


def test_a_folder_may_stand_in_the_search_path(cli, tmp_path):
    own = tmp_path / "own" / "noise"
    own.mkdir(parents=True)
    (own / "mine.yaml").write_text("position: 0.0\ndistribution: none\nresolution: 0.0\nvelocity: exact\n")
    assert cli(f"hydra.searchpath=[file://{own.parent}]", "noise=mine", "duration=0.05").code == 0
    ending = cli(f"hydra.searchpath=[file://{tmp_path}/nowhere]")
    assert (ending.code, "is no folder; allowed: folders" in ending.err) == (2, True)


def test_what_an_installed_plugin_of_hydra_s_adds_stays():
    path = ConfigSearchPathImpl()
    path.append("hydra-colorlog", "pkg://hydra_plugins.hydra_colorlog.conf")
    refuse_modules(path)


def test_the_environment_enters_by_the_command_line_alone(cli, stranger, monkeypatch):
    monkeypatch.setenv("RUNNER_SECRET", "hidden")
    ending = stranger("robot: {name: '${oc.env:RUNNER_SECRET}'}")
    assert ending.code == 2
    assert "trap.yaml, line 4: '${oc.env:RUNNER_SECRET}' calls a function" in ending.err
    assert "hidden" not in ending.err
    ending = cli("robot.name=${oc.env:RUNNER_SECRET}", "duration=0.05")
    assert "name: hidden" in (ending.folder / "config.yaml").read_text()


def test_a_way_out_of_our_folder_is_no_way_around_the_check(stranger, tmp_path):
    (tmp_path / "bomb.yaml").write_text("a: " + "[" * 10_000)
    there = os.path.relpath(tmp_path / "bomb", conf_dir() / "experiment")
    ending = stranger(f"defaults: [{there}]")
    assert ending.code == 2
    assert "bomb.yaml, line 1: nested deeper than 30 levels" in ending.err


@pytest.mark.parametrize("address", ["3", "[a]", "true"])
def test_an_address_is_a_text(cli, address):
    ending = cli("-m", "robot=macro", "seed=1,2", f"hydra.sweeper.address={address}")
    assert ending.code == 2
    assert "hydra.sweeper.address: must be that of a Dask scheduler, as tcp://127.0.0.1:8786, or null" in ending.err
