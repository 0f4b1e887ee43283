"""`runner doctor` on arms that we do not ship, against what then runs and what is refused."""

import pytest
from support import strangers

import runner

KUKA = strangers.DATA / "kuka_iiwa/model.urdf"


@pytest.mark.bullet
def test_from_a_stranger_s_urdf_to_a_report_in_three_commands(cli, tmp_path):
    examined = cli("doctor", KUKA, "--output", "mine")
    assert examined.code == 0
    assert examined.out.splitlines()[-2:] == ["runner --config-dir mine robot=lbr_iiwa", "mine"]
    assert len((tmp_path / "mine/robot/lbr_iiwa.yaml").read_text().splitlines()) <= 19
    ran = cli("--config-dir", "mine", "robot=lbr_iiwa", "duration=0.2")
    assert ran.code == 0
    assert runner.open_run(ran.folder).metrics["max_tracking_error"].median < 1e-4
    assert cli("report", ran.folder, "--format", "html").code == 0


FILES = [path for path in sorted(strangers.DATA.rglob("*.urdf")) if not {"random_urdfs", "lego"} & set(path.parts)]
TIPS = dict(strangers.SHIPPED.values())
FEW = ("franka_panda/panda.urdf", "cartpole.urdf", "cube_no_rotation.urdf")


def fits(cli, path, folder):
    """Let the doctor write a config of a file into a folder, and run it for 0.1 s; return whether it could be taken."""
    tip = TIPS.get(path.relative_to(strangers.DATA).as_posix())
    given = ["--tip", tip] if tip else []
    written = cli("doctor", path, *given, "--output", folder)
    assert written.code in (0, 2)
    if written.code == 2:
        assert written.err or "refused" in written.out, path
        return False
    (urdf,) = (written.folder / "robots").iterdir()
    again = cli("doctor", urdf, *given)
    assert again.code == 0, again.out
    name = next((written.folder / "robot").iterdir()).stem
    run = runner.run(f"robot={name}", "duration=0.1", config_dirs=[written.folder])
    assert run.status == "ok", path
    assert run.metrics["max_tracking_error"].median < 1e-4, path
    return True


@pytest.mark.bullet
@pytest.mark.costs(3)
def test_files_of_pybullet_run_with_what_was_written_or_are_refused(cli):
    assert [fits(cli, strangers.DATA / name, f"mine{number}") for number, name in enumerate(FEW)] == [
        *2 * [True],
        False,
    ]


# More than ninety files: `make test` takes two that fit and one that is refused.
@pytest.mark.slow
@pytest.mark.bullet
def test_every_file_of_pybullet_runs_or_is_refused_with_the_reason(cli):
    assert len(FILES) > 90
    fit = {path for number, path in enumerate(FILES) if fits(cli, path, f"mine{number}")}
    names = {path.relative_to(strangers.DATA).as_posix() for path in fit}
    assert {"kuka_iiwa/model.urdf", "xarm/xarm6_robot.urdf", "pendulum5.urdf", "cartpole.urdf", *TIPS} <= names


@pytest.mark.bullet
def test_the_page_shows_robot_and_findings(cli, tmp_path):
    ending = cli("doctor", KUKA, "--output", tmp_path / "page", "--format", "html")
    assert ending.out.splitlines()[-1] == str(tmp_path / "page")
    page = (tmp_path / "page/report.html").read_text()
    assert '<figure class="playback' in page
    assert "--name gives another" in page
    assert 'class="badge none"' in page
    assert ">0 s<" not in page


@pytest.mark.bullet
def test_nothing_is_overwritten(cli):
    with strangers.short_examination():
        cli("doctor", KUKA, "--output", "mine")
        ending = cli("doctor", KUKA, "--output", "mine")
    assert ending.code == 2
    assert "exists already; choose another folder, or remove it" in ending.err


@pytest.mark.bullet
def test_what_is_barred_is_not_written(cli):
    ending = cli("doctor", strangers.DATA / "cube_no_rotation.urdf", "--output", "mine")
    assert ending.code == 2
    assert "first correct what is refused above" in ending.err


@pytest.mark.bullet
def test_config_and_page_in_one_folder(cli):
    with strangers.short_examination():
        ending = cli("doctor", KUKA, "-o", "mine", "--format", "config,html")
    assert ending.code == 0
    assert sorted(entry.name for entry in ending.folder.iterdir()) == ["report.html", "robot", "robots", "schema.json"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("none.urdf",), "none.urdf: no such file"),
        ((), "required: FILE"),
        (("none.urdf", "--format", "html"), "--format needs --output DIR"),
        (("none.urdf", "--format", "pdf"), "--format: unknown name 'pdf'. Allowed: config, html"),
    ],
)
def test_bad_input(cli, arguments, said):
    ending = cli("doctor", *arguments)
    assert ending.code == 2
    assert said in ending.err


def test_columns_of_joints_that_slide_are_in_metres(cli):
    strangers.robot("crane")
    run = runner.run("robot=crane", "duration=0.1", config_dirs=[strangers.folder()])
    assert [run.units[name] for name in ("q1", "q3", "dq3", "tau2", "tau3")] == ["rad", "m", "m/s", "N m", "N"]
    assert run.metrics["peak_joint_force"].unit == "N"
