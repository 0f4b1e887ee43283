"""An arm, a controller and a trajectory from outside the package, used with the wheel, against their own bands."""

import shlex
import shutil
import sys
from functools import partial
from pathlib import Path

import pytest
from support.pages import ROOT
from support.patience import wait_until
from support.printed import without_caveats, without_results

import runner
from runner.sweeps import run as sweeps_run
from runner.sweeps import work
from runner.sweeps.deadline import deadline
from runner.sweeps.estimate import Estimate

EXAMPLE = ROOT / "examples" / "own_robot"
PARTS = ("--plugin", "controller=gravity_pd.py", "--plugin", "trajectory=helix.py", "--config-dir", ".")


@pytest.fixture(scope="module")
def place(installed, tmp_path_factory):
    """The example as the wheel copies it, and the environment of the wheel."""
    top = tmp_path_factory.mktemp("own")
    copied = installed.call(top, "runner", "example", "examples")
    assert copied.returncode == 0, copied.stderr
    return top / "examples" / "own_robot", installed


FREQUENCIES = "controller.natural_frequency=60,20"


def write_faulty(folder, name, fault):
    """Write the example's controller with a fault in its torque."""
    source = (EXAMPLE / "gravity_pd.py").read_text()
    faulty = source.replace("gravity_pd", name).replace("        return torque\n", f"        {fault}\n")
    (folder / f"{name}.py").write_text(faulty)
    config = (EXAMPLE / "controller" / "gravity_pd.yaml").read_text()
    (folder / "controller" / f"{name}.yaml").write_text(config.replace("gravity_pd", name))


def call(place, *command):
    folder, installed = place
    return installed.call(folder, *command)


@pytest.mark.costs(5)
def test_the_check_is_good_and_its_run_as_stored_by_the_users_parts(place, tmp_path):
    place = (shutil.copytree(place[0], tmp_path / "own_robot", ignore=shutil.ignore_patterns("outputs")), place[1])
    ending = call(place, "./check.sh")
    assert (ending.returncode, without_caveats(without_results(ending.stderr))) == (0, "")
    assert ending.stdout == "good: 4 metrics of 1 run lie in the bands of baseline.yaml\n"
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


@pytest.mark.costs(2)
def test_a_part_that_goes_wrong_is_told_with_its_place_and_the_sweep_goes_on(place):
    write_faulty(place[0], "faulty", "return torque / 0.0 if self.config.natural_frequency > 50.0 else torque")
    parts = ("--plugin", "controller=faulty.py", *PARTS[2:], "duration=0.2", "hydra.sweeper.workers=0")
    ending = call(place, "runner", "-m", *parts, "robot=lamp", "controller=faulty", FREQUENCIES)
    assert ending.returncode == 1
    assert "GravityPD.torque (faulty.py, line " in ending.stderr
    statuses = [run.status for run in runner.open_sweep(place[0] / ending.stdout.splitlines()[-1]).runs()]
    assert statuses == ["failed", "ok"]


def test_a_part_that_never_ends_is_told_with_its_place_and_the_sweep_goes_on(tmp_path, cli, monkeypatch):
    """Its time limit passes once it is in its endless loop."""
    shutil.copytree(EXAMPLE, tmp_path / "mine", ignore=shutil.ignore_patterns("__pycache__", "outputs"))
    monkeypatch.chdir(tmp_path / "mine")
    write_faulty(
        Path(),
        "endless",
        "while self.config.natural_frequency > 50.0:\n            LOOPS.append(1)\n        return torque",
    )
    source = Path("endless.py").read_text()
    Path("endless.py").write_text(f"LOOPS = []\n{source}")

    def loops():
        return len(getattr(sys.modules.get("endless"), "LOOPS", ()))

    def wait(ended, _):
        before = loops()
        wait_until(lambda: ended.is_set() or loops() > before)
        return ended.is_set()

    monkeypatch.setattr(work, "deadline", partial(deadline, wait=wait))
    monkeypatch.setattr(sweeps_run, "estimate", lambda *_: Estimate(1.0))  # which would come to the loop, too
    parts = ("--plugin", "controller=endless.py", "--plugin", "trajectory=helix.py", "--config-dir", ".")
    words = ("duration=0.2", "sweep.time_limit=30", "hydra.sweeper.workers=0")
    ending = cli("-m", *parts, "robot=lamp", "controller=endless", *words, FREQUENCIES)
    assert ending.code == 1
    assert "no result within sweep.time_limit, 30 s (endless.py, line " in ending.err
    assert [run.status for run in runner.open_sweep(ending.folder).runs()] == ["failed", "ok"]


def test_the_controller_is_short():
    assert len((EXAMPLE / "gravity_pd.py").read_text().splitlines()) <= 50
