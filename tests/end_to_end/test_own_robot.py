"""The worked example outside the package, from a temporary folder, with the wheel instead of the checkout."""

import os
import shlex
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import yaml
from support.printed import without_caveats, without_results

import runner

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "own_robot"
PARTS = ("--plugin", "controller=gravity_pd.py", "--plugin", "trajectory=helix.py", "--config-dir", ".")


@pytest.fixture(scope="module")
def place(wheel, tmp_path_factory):
    """A copy of the example, and an environment in which `runner` is the wheel's."""
    top = tmp_path_factory.mktemp("own")
    zipfile.ZipFile(wheel).extractall(top / "site")
    shutil.copytree(EXAMPLE, top / "mine", ignore=shutil.ignore_patterns("__pycache__", "outputs"))
    (top / "bin").mkdir()
    command = top / "bin" / "runner"
    command.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m runner "$@"\n')
    command.chmod(0o755)
    path = f"{top / 'bin'}{os.pathsep}{os.environ['PATH']}"
    return top / "mine", {**os.environ, "PYTHONPATH": str(top / "site"), "PATH": path}


def call(place, *command):
    folder, environment = place
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_the_wheel_is_what_runs(place):
    ending = call(place, sys.executable, "-c", "import runner; print(runner.__file__)")
    assert Path(ending.stdout.strip()).is_relative_to(place[0].parent / "site")


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


def test_the_check_falls_short_of_another_reference(place):
    reference = yaml.safe_load((EXAMPLE / "reference.yaml").read_text())
    reference["metrics"]["max_tracking_error"] = {"max": 1e-5, "reason": "a wish"}
    (place[0] / "wish.yaml").write_text(yaml.safe_dump(reference))
    folder = call(place, "runner", *PARTS, "experiment=lamp_helix").stdout.strip()
    ending = call(place, "runner", "check", folder, "--reference", "wish.yaml")
    assert ending.returncode == 1
    assert "1 of 4 metrics fall short" in ending.stdout


@pytest.fixture(scope="module")
def sweep(place):
    """A sweep over two values, one of which the controller's author did not think of."""
    return call(
        place,
        "runner",
        "-m",
        *PARTS,
        "experiment=lamp_helix",
        "repetitions=1",
        "controller.natural_frequency=20,60",
        "hydra.sweeper.workers=0",
    )


def test_a_sweep_tells_stiff_from_soft(place, sweep):
    assert sweep.returncode == 0, sweep.stderr
    runs = [runner.open_run(folder) for folder in (place[0] / "outputs" / "runs").iterdir()]
    errors = {
        run.config["controller"]["natural_frequency"]: run.metrics["max_tracking_error"].median
        for run in runs
        if run.config["repetitions"] == 1
    }
    # Without feedforward of the acceleration a PD law lags as 1 / omega_n^2; the noise is a hundredth of it.
    assert errors[20.0] / errors[60.0] == pytest.approx(9.0, rel=0.1)


def test_a_report_with_the_motion_is_made_of_the_sweep(place, sweep):
    ending = call(place, "runner", "report", sweep.stdout.splitlines()[-1], "--html")
    assert (ending.returncode, without_caveats(without_results(ending.stderr))) == (0, "")
    page = (place[0] / ending.stdout.splitlines()[-1] / "report.html").read_text()
    assert "lamp" in page
    assert page.count('<figure class="playback"') == 2


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
