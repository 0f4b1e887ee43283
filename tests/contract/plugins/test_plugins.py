"""Plug-ins: named on the command line, hashed, inherited by workers; their errors are placed."""

import io
import json
import os
import re
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout

import pytest
from support.printed import without_caveats, without_results

from runner.base.errors import RunnerError
from runner.cli.main import dispatch
from runner.plugins import discovery

SPRING = '''\
"""A spring in every joint that pulls it home."""

from typing import Literal

from pydantic import PositiveFloat

from runner.controllers import Loop
from runner.plugins.registry import StrictModel


class SpringConfig(StrictModel):
    kind: Literal["spring"]
    period: PositiveFloat
    stiffness: PositiveFloat


class Spring:
    def __init__(self, model, home, stiffness):
        self.model, self.home, self.stiffness = model, home, stiffness

    def reset(self):
        pass

    def torque(self, time, q, dq, reference):
        return self.stiffness * (self.home - q) - 2.0 * dq + self.model.gravity_torque(q)


CONFIG = SpringConfig


def build(config, robot):
    law = Spring(robot.model, robot.home, config.stiffness)
    return (Loop("arm", slice(0, robot.model.nq), config.period, law),)
'''
COMMAND = ("--config-dir", "mine", "robot=macro", "controller=spring", "duration=0.1", "plant=rk4")
PLUGIN = ("--plugin", "controller=mine/spring.py")


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A user's folder with a module and the config that chooses it, and no part named yet."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("RUNNER_PLUGINS", raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setattr(sys, "argv", ["runner"])
    (tmp_path / "mine/controller").mkdir(parents=True)
    (tmp_path / "mine/spring.py").write_text(SPRING)
    (tmp_path / "mine/controller/spring.yaml").write_text("kind: spring\nperiod: 0.01\nstiffness: 50.0\n")
    yield tmp_path
    forget()


def forget():
    """Remove all parts that a test has registered in this process."""
    os.environ.pop("RUNNER_PLUGINS", None)
    sys.modules.pop("spring", None)


def process(*arguments):
    return subprocess.run([sys.executable, "-m", "runner", *arguments], capture_output=True, text=True, check=False)


def runner(*arguments):
    """Do the same in this process, as if it were a new one."""
    forget()
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        code = dispatch(arguments)
    return subprocess.CompletedProcess(arguments, code, out.getvalue(), err.getvalue())


def folder(ending):
    return ending.stdout.splitlines()[-1]


@pytest.mark.costs(2)
def test_a_module_named_on_the_command_line_runs_and_is_recorded(mine):
    ending = process(*PLUGIN, *COMMAND)
    assert (ending.returncode, without_caveats(without_results(ending.stderr))) == (0, "")
    found = json.loads((mine / folder(ending) / "metrics.json").read_text())["provenance"]
    assert list(found["plugins"]) == ["controller=mine/spring.py"]
    assert found["command"] == (
        "runner --plugin controller=mine/spring.py --config-dir mine robot=macro controller=spring duration=0.1 "
        "plant=rk4"
    )


def test_the_source_of_a_plug_in_decides_about_the_runs_name(mine):
    script = (
        "from runner import store; from runner.plugins.discovery import use_plugins; "
        "use_plugins(['controller=mine/spring.py']); "
        "print(store.run_hash({'controller': {'kind': 'spring'}}, ''))"
    )

    def name():
        """Return the name in a new process: the source counts as found at its first use."""
        return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout

    first = name()
    assert name() == first
    (mine / "mine/spring.py").write_text(SPRING.replace("2.0 * dq", "3.0 * dq"))
    assert name() != first


def test_a_config_cannot_name_a_module(mine):
    ending = runner(*COMMAND)
    assert ending.returncode == 2
    assert "controller.kind: 'spring' is unknown" in ending.stderr


def test_what_raises_outside_of_the_loop_is_told_with_its_place(mine):
    (mine / "mine/spring.py").write_text(
        SPRING + "\n\ndef start_posture(config, robot, start):\n    return config.postur\n"
    )
    ending = runner(*PLUGIN, *COMMAND)
    assert ending.returncode == 2
    line = len(SPRING.splitlines()) + 4
    assert "controller.kind: 'spring' cannot be built: AttributeError: 'SpringConfig' object" in ending.stderr
    assert ending.stderr.endswith(f"(spring.py, line {line}, in start_posture)\n")


def test_what_a_config_model_of_the_users_raises_is_told_with_its_place(mine):
    check = "    @field_validator('period')\n    def check(cls, period):\n        return {}[period]\n"
    text = SPRING.replace("    stiffness: PositiveFloat\n", f"    stiffness: PositiveFloat\n\n{check}")
    (mine / "mine/spring.py").write_text(text.replace("import PositiveFloat", "import PositiveFloat, field_validator"))
    ending = runner(*PLUGIN, *COMMAND)
    assert ending.returncode == 2
    assert re.match(r"runner: your plug-in failed: KeyError: 0.01 \(spring.py, line \d+, in check\)", ending.stderr)


def test_every_command_takes_a_plug_in_wherever_it_stands(mine):
    assert runner(*COMMAND, "--plugin=controller=mine/spring.py").returncode == 0
    assert runner("list", *PLUGIN, "controllers", "--config-dir", "mine").returncode == 0


def test_a_module_by_name_is_found_where_python_looks(mine, monkeypatch):
    monkeypatch.syspath_prepend(mine / "mine")
    discovery.added_parts("trajectory")
    discovery.use_plugins(["controller=spring"])
    assert next((point.name, point.value) for point in discovery.added_parts("controller")) == ("spring", "spring")
    assert all(point.value != "spring" for point in discovery.added_parts("trajectory"))
    assert discovery.named_parts() == ["controller=spring"]


def test_worker_processes_inherit_plug_ins(mine):
    discovery.use_plugins(["controller=mine/spring.py"])
    script = "from runner.controllers import CONTROLLERS; print('spring' in CONTROLLERS.names())"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout == "True\n"


def test_a_sweep_takes_a_plug_in(mine):
    ending = runner("-m", *PLUGIN, *COMMAND, "controller.stiffness=20,40", "hydra.sweeper.workers=0")
    assert ending.returncode == 0, ending.stderr
    assert len(list((mine / "outputs/runs").iterdir())) == 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "mine/spring.py",
            r"must be GROUP=MODULE, as in controller=mine/spring.py; groups: calibration, controller, endpoint_sensor",
        ),
        ("controler=mine/spring.py", r"did you mean controller\?"),
        ("controller=", r"must be GROUP=MODULE"),
        ("plant", r"must be GROUP=MODULE, as in plant=mine/part.py$"),
        ("controller=mine/spring.py:nan", r"Hydra reads controller=nan as a value, not as a name; rename it"),
        ("noise=mine/Null.py", r"Hydra reads noise=Null as a value"),
        ("controller=mine/absent.py", r"no file mine/absent.py"),
        ("controller=mine.absent", r"no module mine.absent"),
        ("controller=json.py", r"Python has another module json, .*; rename yours"),
    ],
)
def test_what_cannot_be_found_is_said(mine, text, message):
    for name in ("json.py", "mine/Null.py"):
        (mine / name).touch()
    with pytest.raises(RunnerError, match=message):
        discovery.use_plugins([text])


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("import nowhere", r"ModuleNotFoundError: No module named 'nowhere' \(spring.py, line 1"),
        ("def torque(:", r"SyntaxError: invalid syntax \(spring.py, line 1\)"),
        ("CONFIG = {}", r"needs CONFIG, a class derived from"),
    ],
)
def test_a_module_that_cannot_be_used_is_told_with_its_place(mine, source, message):
    (mine / "mine/spring.py").write_text(source + "\n")
    ending = runner(*PLUGIN, *COMMAND)
    assert ending.returncode == 2
    assert len(ending.stderr.splitlines()) <= 3
    assert re.search(message, ending.stderr), ending.stderr


def test_the_source_of_a_package_is_all_of_it(tmp_path, monkeypatch):
    for name in ("__init__.py", "law.py", "deep/helper.py"):
        (tmp_path / "house" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "house" / name).touch()
    monkeypatch.syspath_prepend(tmp_path)
    assert [path.name for path in discovery.source_files("house.law")] == ["__init__.py", "helper.py", "law.py"]
