"""`runner calibrate`: printed errors, warnings and refused input."""

import pytest

from runner.config.compose.files import group_options

SHORT = ("repetitions=3",)


@pytest.mark.parametrize("kind", group_options("calibration"))
def test_every_calibration_prints_its_errors_and_its_folder(cli, tmp_path, kind):
    ending = cli("calibrate", f"calibration={kind}", *SHORT, "-o", "outputs")
    assert (ending.code, ending.err) == (0, "")
    assert ending.folder.parent == tmp_path / "outputs" / "calibrations"
    assert ending.out.splitlines()[0].split()[:2] == ["error", "of"]
    assert "mean normalised error squared" in ending.out
    assert [entry.name for entry in tmp_path.iterdir()] == ["outputs"]


def test_the_bare_command_finds_the_tool_centre_point_of_the_meca500(cli):
    lines = cli("calibrate", *SHORT).out.splitlines()
    assert [line.split()[0] for line in lines[1:4]] == ["x", "y", "z"]


def test_without_noise_there_is_nothing_to_judge(cli):
    ending = cli("calibrate", "calibration.repeatability=0", *SHORT)
    assert ending.code == 0
    assert "normalised" not in ending.out


def test_an_overload_and_a_heavy_tool_are_warned_of(cli):
    ending = cli("calibrate", "calibration=gravity", "robot.tool.mass=3", *SHORT)
    assert ending.code == 0
    assert "warning: robot.tool.mass and robot.payload.mass: 3 and 0 kg are more than the 0.5 kg" in ending.err
    assert "beyond the sensor's range of 20 N; its reading stayed there" in ending.err
    assert cli("calibrate", "calibration=gravity", "robot.tool.mass=3", *SHORT) == ending  # cached, printed again


def test_all_problems_are_told_at_once(cli, tmp_path):
    ending = cli(
        "calibrate", "controller.period=3", "robots=xarm7", "wrist_sensor.range=[1]", "calibration.spred=1", "seed=-1"
    )
    assert (ending.code, ending.out) == (2, "")
    for text in (
        "5 problems in the config",
        "controller.period: a calibration reads no such key; keys: seed, repetitions, gravity",
        "robots: a calibration reads no such key (did you mean robot?)",
        "wrist_sensor.range: must have 6 values; found 1",
        "calibration.spred: unknown key (did you mean spread?)",
        "seed: must be 0 or more; found -1",
    ):
        assert text in ending.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("overrides", "text"),
    [
        (("calibration.poses=2",), "calibration.poses: 2 poses; a tool centre point needs 3 or more"),
        (("calibration.spread=0.001",), "condition number"),
        (
            ("calibration.spread=0.9",),
            "calibration.spread: 0.9 rad is more than the arm can do with the tip at ",
        ),
        (("calibration.spread=4",), "calibration.spread: must be below 3.14159; found 4"),
        (("calibration.posture=[1,2]",), "calibration.posture: must have 6 values, or be null; found [1.0, 2.0]"),
        (("robot=xarm7",), "robot.tool: found null; a calibration needs a tool"),
        (("calibration=grav",), "calibration: no 'grav' (did you mean gravity?)"),
        (("calibration.kind=grav",), "calibration.kind: 'grav' is unknown (did you mean gravity?)"),
        (("calibration=gravity", "gravity=0"), "gravity: must be above 0; found 0"),
        (("calibration=gravity", "calibration.orientations=2"), "weighing a tool needs 3 or more"),
        (("calibration=gravity", "calibration.choice=worst"), "allowed: best, first"),
        (
            ("calibration=gravity", "calibration.choice=first", "calibration.candidates=9"),
            "calibration.candidates: 9 are left for 16 orientations",
        ),
        (("calibration=gravity", "calibration.candidates=9"), "16 wanted of 9 candidates"),
        (("calibration=tool_direction", "calibration.direction=[0,0,0]"), "calibration.direction: must not be zero"),
    ],
)
def test_bad_input_ends_with_what_is_wrong(cli, overrides, text):
    ending = cli("calibrate", *overrides, *SHORT)
    assert (ending.code, ending.out) == (2, "")
    assert text in ending.err


def test_a_calibration_is_no_run(cli):
    ending = cli("calibration=gravity")
    assert ending.code == 2
    assert "calibration" in ending.err


def test_an_own_folder_adds_calibrations(cli, tmp_path):
    own = tmp_path / "own" / "calibration"
    own.mkdir(parents=True)
    (own / "mine.yaml").write_text(
        "# Mine\nkind: tool_centre_point\nposes: 5\nspread: 0.2\nposture: null\nrepeatability: 1e-6\n"
    )
    ending = cli("calibrate", "--config-dir", tmp_path / "own", "calibration=mine", *SHORT)
    assert ending.code == 0
    assert "mine" in cli("list", "calibrations", "--config-dir", tmp_path / "own").out


def test_unknown_arguments_show_the_usage(cli):
    ending = cli("calibrate", "--all")
    assert ending.code == 2
    assert ending.err.startswith("runner: unrecognized arguments: --all. Usage: runner calibrate [--config-dir DIR]")
