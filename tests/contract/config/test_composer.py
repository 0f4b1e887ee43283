"""Composing with what is kept of earlier configs: against Hydra, which composes each line again."""

import shutil

import hydra
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runner.base import engines, paths
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose, resolve
from runner.config.compose.composer import Composer, check_composed
from runner.config.compose.composition_errors import COMPOSITION_ERRORS, explain
from runner.config.compose.overrides import force
from runner.config.compose.sources import VERSION_BASE, checked_sources
from runner.config.compose.unresolved import from_hydra

SHORT = ("robot=macro", "plant=rk4", "duration=0.05")


def plain(overrides, config_dirs=(), root="config"):
    """Compose as `compose` does, by Hydra's own function, which keeps nothing."""
    folder = str(paths.conf_dir())
    try:
        with checked_sources(config_dirs), hydra.initialize_config_dir(folder, job_name="runner", **VERSION_BASE):
            config = hydra.compose(root, force(overrides), return_hydra_config=True)
        config.hydra.overrides.task, config.hydra.job.override_dirname = [], ""  # the Composer gives Hydra only options
        check_composed(config)
        return resolve(from_hydra(config), overrides, config_dirs, root)
    except COMPOSITION_ERRORS as error:
        raise explain(error, config_dirs) from None


def outcome(way, *arguments):
    """Return the config, or the message of the refusal."""
    try:
        return way(*arguments)
    except ConfigError as error:
        return str(error)


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("experiment=thesis/figure_5_8", "preset=as_reported", "plant=bullet", "plant.step=1e-3", "repetitions=1"),
        (
            "robot=combined",
            "noise.position={macro: 1e-3, mini: 0}",
            "controller.singularity_damping=0.2",
            "trajectory.goal=[0.3,0.1,0.2]",
            "outputs=/some/where else",
        ),
        ("robot=macro", "controller.natural_frequency=${robot.torque_limit}", "noise.position='1e-3'"),
        ("robot=macro", "noise.positon=1", "nonsense=3", "controller.period=null"),
        ("robot=macro", "noise=thesis", "noise.position=1e-4", "noise.position=1e-5", "noise=none"),
        ("noise={position: 1e-3}", "noise=thesis", "robot=mini"),
        ("noise.position=1e-3", "noise={position: 2e-3}", "noise={velocity: exact}"),
        ("robot=macro", "+new.key=[1,{a: b}]", "~torque_limits"),
        ("robot=macro", "~notch.kind", "++a.b=1", "+experiment=thesis/figure_3_5"),
        ("robot=macro", "noise@other=thesis"),
        ("robot=macro", "hydra.sweeper.workers=0"),
        ("robot=makro", "seed=1"),
        ("noise.position=[1,", "robot=macro"),
        ("seed=1,2",),
        ("robot=macro,mini",),
        ("foo",),
        ("robot=macro", "seed.deeper=1"),
        ("hydra.sweeper.params={seed: {_target_: os.getcwd}}",),
        ("noise.position=${noise.resolution}", "noise.resolution=${noise.position}"),
        ("noise.position=${robot.nope}",),
        ("++noise=thesis",),
    ],
    ids=" ".join,
)
def test_a_line_gives_what_hydra_gives_the_first_time_and_the_second(overrides):
    expected = outcome(plain, overrides)
    assert [outcome(compose, overrides) for _ in range(2)] == [expected, expected]


CHOICES = {
    "robot": ("macro", "combined"), "noise": ("none", "thesis"), "torque_limits": ("none", "thesis", "nope"),
    "+experiment": ("thesis/figure_3_9",), "noise@second": ("thesis",),
}  # fmt: skip
KEYS = ("noise.position", "controller.period", "controller.period.macro", "noise", "new.key", "seed", "robot.tip.x")
VALUES = ("1e-3", "[1,2]", "{position: 2e-3}", "null", "'a b'", "${robot.period}", "20ms", "1,2", "[1", "true")


def line():
    choice = st.sampled_from([f"{group}={name}" for group, names in CHOICES.items() for name in names])
    value = st.builds("{}{}={}".format, st.sampled_from(("", "", "", "+", "++")), *map(st.sampled_from, (KEYS, VALUES)))
    gone = st.sampled_from(("~noise", "~seed", "~noise.position", "~nothing"))
    return st.lists(st.one_of(choice, value, value, gone), max_size=4)


@pytest.mark.costs(2)
@settings(max_examples=10)
@given(line())
def test_random_lines_give_what_hydra_gives(overrides):
    assert outcome(compose, overrides) == outcome(plain, overrides)


def test_a_calibration_and_a_run_of_the_same_options_stay_apart():
    for root in ("config", "calibrate", "config"):
        assert compose(["robot=meca500"], root=root) == plain(["robot=meca500"], root=root)


def test_other_values_compose_nothing_anew(monkeypatch):
    compose(["robot=macro", "seed=1"])
    monkeypatch.setattr(Composer, "hydra", None)
    assert compose(["robot=macro", "seed=2", "noise.position=1e-3"]).resolved["seed"] == 2


def test_what_is_changed_in_one_config_is_in_no_other():
    first = Composer().load(["robot=combined"])
    first.robot.stages = None
    composed = compose(["robot=combined"])
    composed.resolved["robot"]["stages"].clear()
    composed.resolved["noise"]["position"] = 5.0
    assert compose(["robot=combined"]) == plain(["robot=combined"])


@pytest.fixture
def own(tmp_path):
    """A config folder with one option of the group noise."""
    folder = tmp_path / "own"
    (folder / "noise").mkdir(parents=True)
    (folder / "noise/own.yaml").write_text("defaults: [thesis]\nposition: 1e-3\n")
    return folder


def position(folder):
    return compose(["robot=macro", "noise=own"], [folder]).resolved["noise"]["position"]


def test_an_edited_file_of_the_user_is_noticed(own):
    assert [position(own), position(own)] == [1e-3, 1e-3]
    (own / "noise/own.yaml").write_text("defaults: [thesis]\nposition: 2e-3\n")  # of the same length
    assert [position(own), position(own)] == [2e-3, 2e-3]


def test_an_option_is_known_when_it_is_there_and_unknown_when_it_is_gone(own):
    file = own / "noise/own.yaml"
    text = file.read_text()
    for _ in range(2):
        file.unlink()
        assert "noise: no 'own'" in outcome(compose, ["noise=own"], [own])
        file.write_text(text)
        assert position(own) == 1e-3


def test_a_folder_named_from_another_working_folder_is_another(own, tmp_path, monkeypatch):
    other = tmp_path / "elsewhere"
    shutil.copytree(own, other / "own", copy_function=shutil.copy2)  # of the same time and length
    (other / "own/noise/own.yaml").write_text("defaults: [thesis]\nposition: 2e-3\n")
    found = []
    for folder in (tmp_path, other):
        monkeypatch.chdir(folder)
        found.append(position(own.relative_to(tmp_path)))
    assert found == [1e-3, 2e-3]


def test_an_edited_file_of_ours_is_noticed(tmp_path, monkeypatch):
    shutil.copytree(paths.conf_dir(), tmp_path / "conf")
    monkeypatch.setattr(paths, "_root", lambda: tmp_path)
    line = ["robot=combined", "noise=thesis"]
    robot = tmp_path / "conf/robot/combined.yaml"
    robot.write_text(robot.read_text().replace("armature: 0.0", ""))  # robot_defaults.yaml gives it
    for name, now, then in (
        ("noise/thesis.yaml", "uniform", "gaussian"),
        ("robot_defaults.yaml", "armature: 0.0", "armature: 0.5"),  # which each stage takes
    ):
        file = tmp_path / "conf" / name
        before = compose(line)
        file.write_text(file.read_text().replace(now, then))
        after = compose(line)
        assert after == plain(line)
        assert after != before


def test_a_folder_of_very_many_files_is_left_to_hydra(own):
    for number in range(1001):
        (own / f"{number}.csv").touch()
    for value in (1e-3, 2e-3):
        (own / "noise/own.yaml").write_text(f"defaults: [thesis]\nposition: {value}\n")
        assert position(own) == value


def test_a_folder_that_holds_itself_is_left_to_hydra(own):
    (own / "again").symlink_to(own)
    assert position(own) == 1e-3


def test_a_value_mends_a_file_that_refers_to_itself(own):
    (own / "noise/own.yaml").write_text("defaults: [thesis]\nposition: ${noise.position}\n")
    assert "noise.position: refers to itself" in outcome(compose, ["noise=own"], [own])
    line = ["noise=own", "noise.position=3e-3"]
    assert compose(line, [own]) == plain(line, [own])


@pytest.mark.bullet
def test_default_stands_for_the_plant_that_is_installed(monkeypatch):
    for found in (True, False, True):
        monkeypatch.setattr(engines, "has_pybullet", lambda found=found: found)
        assert compose(["robot=macro"]) == plain(["robot=macro"])


@pytest.mark.costs(2)
@pytest.mark.parametrize("mode", [(), ("-m", "hydra.sweeper.workers=0")])
def test_a_command_line_makes_what_hydras_own_command_makes(cli, mode):
    ours = cli(*mode, *SHORT, "++seed=3", "noise={position: 1e-3}")
    hydras = cli(*mode, *SHORT, "++seed=3", "noise={position: 1e-3}", "--config-name", "config")
    assert ours.folder == hydras.folder
    assert (ours.code, hydras.code) == (0, 0)
