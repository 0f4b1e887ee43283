"""An arm, a controller and a trajectory from outside the package, used with the wheel, against their own bands."""

import shlex

import pytest
from support.pages import ROOT
from support.printed import without_caveats, without_results

import runner

EXAMPLE = ROOT / "examples" / "own_robot"
PARTS = ("--plugin", "controller=gravity_pd.py", "--plugin", "trajectory=helix.py", "--config-dir", ".")


@pytest.fixture(scope="module")
def place(installed, tmp_path_factory):
    """The example as the wheel copies it, and the environment of the wheel."""
    top = tmp_path_factory.mktemp("own")
    copied = installed.call(top, "runner", "example", "examples")
    assert copied.returncode == 0, copied.stderr
    return top / "examples" / "own_robot", installed


def call(place, *command):
    folder, installed = place
    return installed.call(folder, *command)


@pytest.mark.costs(5)
def test_the_check_is_good_and_its_run_as_stored_by_the_users_parts(place):
    ending = call(place, "./check.sh")
    assert (ending.returncode, without_caveats(without_results(ending.stderr))) == (0, "")
    assert ending.stdout == "good: 4 metrics of 1 run lie in the bands of reference.yaml\n"
    (folder,) = (place[0] / "outputs" / "runs").iterdir()
    run = runner.open_run(folder)
    assert run.config["robot"]["name"] == "lamp"
    assert set(run.provenance["plugins"]) == {"controller=gravity_pd.py", "trajectory=helix.py"}
    assert len(run.trace()) == 5001
    again = call(place, *shlex.split(run.provenance["command"]))
    assert again.stdout == f"outputs/runs/{folder.name}\n"  # the command that it names finds it


@pytest.mark.costs(3)
def test_a_sweep_tells_stiff_from_soft(place):
    sweep = call(
        place,
        "runner",
        "-m",
        *PARTS,
        "experiment=lamp_helix",
        "repetitions=1",
        "controller.natural_frequency=20,60",
        "hydra.sweeper.workers=0",
    )
    assert sweep.returncode == 0, sweep.stderr
    runs = runner.open_sweep(place[0] / sweep.stdout.splitlines()[-1]).runs()
    errors = {run.config["controller"]["natural_frequency"]: run.metrics["max_tracking_error"].median for run in runs}
    # Without feedforward of the acceleration a PD law lags as 1 / omega_n^2; the noise is a hundredth of it.
    assert errors[20.0] / errors[60.0] == pytest.approx(9.0, rel=0.1)


@pytest.mark.parametrize(
    ("name", "fault", "said", "workers"),
    [
        ("faulty", "return torque / 0.0 if self.config.natural_frequency > 50.0 else torque", "GravityPD.torque (", 0),
        ("endless", "while self.config.natural_frequency > 50.0:\n            pass\n        return torque", "2 s (", 1),
    ],
)
def test_a_part_that_goes_wrong_is_told_with_its_place_and_the_sweep_goes_on(place, name, fault, said, workers):
    source = (EXAMPLE / "gravity_pd.py").read_text()
    faulty = source.replace("gravity_pd", name).replace("        return torque\n", f"        {fault}\n")
    (place[0] / f"{name}.py").write_text(faulty)
    (place[0] / "controller" / f"{name}.yaml").write_text(
        (EXAMPLE / "controller" / "gravity_pd.yaml").read_text().replace("gravity_pd", name)
    )
    parts = [
        "--plugin",
        f"controller={name}.py",
        *PARTS[2:],
        "sweep.time_limit=2",
        "duration=0.2",
        f"hydra.sweeper.workers={workers}",
    ]
    ending = call(
        place, "runner", "-m", *parts, "robot=lamp", f"controller={name}", "controller.natural_frequency=60,20"
    )
    assert ending.returncode == 1
    assert f"{said}{name}.py, line " in ending.stderr
    statuses = [run.status for run in runner.open_sweep(place[0] / ending.stdout.splitlines()[-1]).runs()]
    assert statuses == ["failed", "ok"]


def test_the_controller_is_short():
    assert len((EXAMPLE / "gravity_pd.py").read_text().splitlines()) <= 50
