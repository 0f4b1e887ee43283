import copy
import functools
import gc
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import compiled_once
import composing
import numpy as np
import pytest
from hypothesis import settings

from runner.config.compose import compose
from runner.config.run import RunConfig
from runner.config.validation import validate
from runner.quiet import quiet_environment

quiet_environment()
composing.begin()

from runner.assembly import assemble  # noqa: E402 - after the environment
from runner.cli import dispatch  # noqa: E402
from runner.engines import has_pybullet  # noqa: E402
from runner.loop.sensors import make_sensors  # noqa: E402
from runner.robots import RobotModel, find_urdf, read_urdf  # noqa: E402
from runner.robots.robot import Robot, Stage  # noqa: E402
from runner.simulation import ClosedLoop, simulate  # noqa: E402
from runner.trace import Trace  # noqa: E402

pytest_plugins = ("cost", "engines", "own_parts")

settings.register_profile("runner", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("runner")


def read_thesis_urdf(name: str) -> str:
    return read_urdf(find_urdf(f"{name}.urdf"), {})


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip what needs PyBullet where it is not installed: what is marked so, and what has bullet for a parameter."""
    missing = pytest.mark.skip(reason="PyBullet is not installed")
    for item in () if has_pybullet() else items:
        given = getattr(item, "callspec", None)
        asked = given is not None and any(map(_names_bullet, given.params.values()))
        if asked or item.get_closest_marker("bullet"):
            item.add_marker(missing)


def _names_bullet(value: Any) -> bool:
    return isinstance(value, str | tuple | list) and re.search(r"\bbullet\b", str(value)) is not None


def pytest_collection_finish() -> None:
    """Leave what lives as long as the process to no later look for garbage."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def _nothing_kept_of_this_session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    yield
    compiled_once.forget(tmp_path_factory.getbasetemp())


@pytest.fixture
def plain_hydra() -> Iterator[None]:
    """Lets Hydra alone compose."""
    with composing.plainly():
        yield


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Lets commands that a test starts hear Ctrl-C; a shell that started the tests in the background ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def macro_urdf() -> str:
    return read_thesis_urdf("macro")


@pytest.fixture(scope="session")
def mini_urdf() -> str:
    return read_thesis_urdf("mini")


@pytest.fixture(scope="session")
def macro(macro_urdf: str) -> RobotModel:
    return RobotModel(macro_urdf, "tip")


@pytest.fixture(scope="session")
def mini(mini_urdf: str) -> RobotModel:
    return RobotModel(mini_urdf, "tip")


@pytest.fixture(scope="session", params=["macro", "mini"])
def arm(request: pytest.FixtureRequest) -> RobotModel:
    """Each thesis arm in turn."""
    return RobotModel(read_thesis_urdf(request.param), "tip")


@pytest.fixture(scope="session")
def one_stage() -> Callable[[str, RobotModel], Robot]:
    """Make a robot of one arm, at home at zero."""

    def make(urdf: str, model: RobotModel) -> Robot:
        stage = Stage("arm", model, urdf, slice(0, model.nq), np.zeros(model.nq), None)
        return Robot(urdf, model, (stage,), model.tip_name)

    return make


@pytest.fixture(scope="session")
def checked_config() -> Callable[..., RunConfig]:
    """Compose and check a config from overrides; noise-free, without torque limits, unless they ask for it."""

    @functools.cache
    def composed(*overrides: str) -> Mapping[str, Any]:
        return compose(overrides).resolved

    return lambda *overrides: validate(copy.deepcopy(composed(*overrides)))


@pytest.fixture(scope="session")
def combined(checked_config: Callable[..., RunConfig]) -> Robot:
    """The Mini riding on the Macro."""
    return checked_config("robot=combined").arm


@pytest.fixture(scope="session")
def xarm7(checked_config: Callable[..., RunConfig]) -> Robot:
    """The UFACTORY xArm7."""
    return checked_config("robot=xarm7", "trajectory=goal").arm


@pytest.fixture
def closed_loop(checked_config: Callable[..., RunConfig]) -> Iterator[Callable[..., ClosedLoop]]:
    """Assemble closed loops from overrides; their plants are released at the end of the test."""
    loops: list[ClosedLoop] = []

    def make(*overrides: str) -> ClosedLoop:
        loops.append(assemble(checked_config(*overrides)))
        return loops[-1]

    yield make
    for loop in loops:
        loop.plant.close()


@pytest.fixture(scope="session")
def simulated(checked_config: Callable[..., RunConfig]) -> Callable[..., Trace]:
    """Simulate one repetition of what overrides describe, past the store."""

    def make(*overrides: str, repetition: int = 0) -> Trace:
        config = checked_config(*overrides)
        loop = assemble(config)
        try:
            return simulate(loop, *make_sensors(loop, config, repetition))
        finally:
            loop.plant.close()

    return make


@pytest.fixture(scope="session")
def hand_made_trace() -> Callable[..., Trace]:
    """Make a trace of a two-joint arm from what a test names; everything else is at rest at zero.

    `tip` and `desired` are positions, one row for each time; `desired` may be a single position.
    """

    def make(
        t, tip=0.0, desired=0.0, q=0.0, dq=0.0, tau=0.0, limits=np.inf, failure=None, units=("rad", "rad")
    ) -> Trace:
        t = np.asarray(t, dtype=float)
        rows = len(t)
        motion = np.zeros((rows, 3, 3))
        motion[:, 0] = desired
        return Trace(
            t=t,
            q=np.zeros((rows, 2)) + q,
            dq=np.zeros((rows, 2)) + dq,
            tau=np.zeros((rows, 2)) + tau,
            end_points=np.zeros((1, rows, 3)) + tip,
            offsets=np.zeros((1, 3)),
            stage_names=("arm",),
            desired=motion,
            limits=np.zeros(2) + limits,
            joint_names=("q1", "q2"),
            joint_units=units,
            tick_seconds=np.zeros(rows - 1),
            failure=failure,
        )

    return make


@pytest.fixture
def simulated_runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the runs that are simulated."""
    from runner.sweeps import work

    names: list[str] = []
    make = work._make

    def note(name, *others):
        names.append(name)
        return make(name, *others)

    monkeypatch.setattr(work, "_make", note)
    return names


@dataclass(frozen=True)
class Ending:
    """How a command line ended: exit code, and what it printed."""

    code: int
    out: str
    err: str

    @property
    def folder(self) -> Path:
        """The folder made: the last line on standard output."""
        return Path(self.out.splitlines()[-1]).resolve()


@pytest.fixture
def cli(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> Callable[..., Ending]:
    """Run command lines within this process, in a working directory of their own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["runner"])  # Hydra reads it

    def call(*arguments: object) -> Ending:
        code = dispatch([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        return Ending(code, printed.out, printed.err)

    return call


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, made by the build backend itself, which needs no network."""
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder],
        cwd=Path(__file__).resolve().parents[1],
        check=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    return next(folder.glob("*.whl"))
