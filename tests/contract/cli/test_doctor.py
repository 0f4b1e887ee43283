import numpy as np
import pytest
from support import strangers

import runner

KUKA = strangers.DATA / "kuka_iiwa/model.urdf"


@pytest.mark.bullet
def test_from_a_stranger_s_urdf_to_a_report_in_three_commands(cli):
    examined = cli("doctor", KUKA, "--write", "mine")
    assert examined.code == 1
    assert examined.out.splitlines()[-2:] == ["runner --config-dir mine robot=lbr_iiwa", "mine"]
    ran = cli("--config-dir", "mine", "robot=lbr_iiwa", "duration=0.2")
    assert ran.code == 0
    assert runner.open_run(ran.folder).metrics["max_tracking_error"].median < 1e-4
    assert cli("report", ran.folder, "--html").code == 0


@pytest.mark.bullet
def test_what_was_written_fits(cli):
    for name, (path, tip) in strangers.SHIPPED.items():
        given = ["--tip", tip] if tip else []
        written = cli("doctor", strangers.DATA / path, *given, "--write", name)
        assert written.code in (0, 1)
        (urdf,) = (written.folder / "robots").iterdir()
        again = cli("doctor", urdf, *given)
        assert again.code == 0, again.out


@pytest.mark.bullet
def test_every_file_of_pybullet_runs_or_is_refused_with_the_reason(cli):
    files = [path for path in sorted(strangers.DATA.rglob("*.urdf")) if not {"random_urdfs", "lego"} & set(path.parts)]
    assert len(files) > 90
    fit = set()
    for number, path in enumerate(files):
        ending = cli("doctor", path, "--write", f"mine{number}")
        assert ending.code in (0, 1, 2)
        if ending.code == 2:
            assert ending.err or "refused" in ending.out, path
        else:
            fit.add(path.relative_to(strangers.DATA).as_posix())
            name = next((ending.folder / "robot").iterdir()).stem
            run = runner.run(f"robot={name}", "duration=0.1", config_dirs=[ending.folder])
            assert run.status == "ok", path
            assert run.metrics["max_tracking_error"].median < 1e-4, path
    assert {"kuka_iiwa/model.urdf", "xarm/xarm6_robot.urdf", "pendulum5.urdf", "cartpole.urdf"} <= fit


@pytest.mark.bullet
def test_the_page_shows_robot_and_findings(cli, tmp_path):
    ending = cli("doctor", KUKA, "--html", tmp_path / "page")
    assert ending.out.splitlines()[-1] == str(tmp_path / "page")
    page = (tmp_path / "page/report.html").read_text()
    assert "__VISER_EMBED_DATA__" in page
    assert "inertia but no mass" in page
    assert 'class="badge note"' in page
    assert ">0 s<" not in page


@pytest.mark.bullet
def test_nothing_is_overwritten(cli):
    cli("doctor", KUKA, "--write", "mine")
    ending = cli("doctor", KUKA, "--write", "mine")
    assert ending.code == 2
    assert "is there already; choose another folder, or remove it" in ending.err


@pytest.mark.bullet
def test_what_is_barred_is_not_written(cli):
    ending = cli("doctor", strangers.DATA / "cube_no_rotation.urdf", "--write", "mine")
    assert ending.code == 2
    assert "first mend what is refused above" in ending.err


@pytest.mark.parametrize(("arguments", "said"), [(("none.urdf",), "no file none.urdf"), ((), "required: FILE")])
def test_bad_input(cli, arguments, said):
    ending = cli("doctor", *arguments)
    assert ending.code == 2
    assert said in ending.err


CONTROLLERS = ("operational_space", "computed_torque", "differential_inverse_kinematics", "whole_body")
PAIRS = [
    pytest.param(controller, name, marks=[pytest.mark.slow] if (row + column) % 2 else [])
    for row, controller in enumerate(CONTROLLERS)
    for column, name in enumerate(strangers.STRANGERS)
]  # each arm is led by two of them in any case, and each leads every other arm


@pytest.mark.parametrize(("controller", "name"), PAIRS)
def test_controllers_lead_strangers(simulated_stranger, name, controller):
    trace = simulated_stranger(name, f"controller={controller}")
    assert trace.failure is None
    assert np.abs(trace.error).max() < 1e-3 * strangers.examined(name).model.reach


@pytest.fixture(scope="module")
def simulated_stranger():
    from runner.assembly import assemble
    from runner.loop.sensors import make_encoders
    from runner.simulation import simulate

    def make(name, *overrides):
        config = strangers.config(name, *overrides, "trajectory.duration=1", "duration=0.6")
        loop = assemble(config)
        try:
            return simulate(loop, make_encoders(loop, config.noise, config.settings.seed, 0))
        finally:
            loop.plant.close()

    return make


@pytest.mark.parametrize("name", ["crane", "planar_two", "mixed"])
def test_the_plants_agree_on_strangers(simulated_stranger, name):
    default, rk4 = (simulated_stranger(name, f"plant={plant}") for plant in ("default", "rk4"))
    np.testing.assert_allclose(default.tip, rk4.tip, rtol=0, atol=1e-5 * strangers.examined(name).model.reach)


def test_columns_of_joints_that_slide_are_in_metres(cli):
    strangers.robot("crane")
    run = runner.run("robot=crane", "duration=0.1", config_dirs=[strangers.folder()])
    assert [run.units[name] for name in ("q1", "q3", "dq3", "tau2", "tau3")] == ["rad", "m", "m/s", "N m", "N"]
    assert run.metrics["peak_joint_force"].unit == "N"
