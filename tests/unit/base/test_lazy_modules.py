"""Libraries that checks of a config do without: they would take most of its time."""

import subprocess
import sys

import pytest

from runner.base.lazy_modules import lapack, pin, splines

CHECK = """
import sys
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.assembly.validation import validate

try:
    validate(compose(sys.argv[1:]))
except ConfigError as error:
    heavy = ("pinocchio", "scipy", "pandas", "matplotlib", "llvmlite")
    print(len(error.problems), *(name for name in heavy if name in sys.modules))
"""


@pytest.mark.parametrize(
    ("overrides", "problems"),
    [
        (["robot=macro", "controller=operational_space", "controler.kp=3"], 1),
        (["robot=combined", "controller=macro_mini", "trajectory=waypoints", "noise.position.makro=1"], 1),
        (["robot=xarm7", "controller=joint_pd", "controller.perid=5ms", "torque_limits.max=[1,2]"], 2),
    ],
)
def test_wrong_configs_are_reported_without_rigid_body_models(overrides, problems):
    done = subprocess.run([sys.executable, "-c", CHECK, *overrides], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(problems)]


def test_a_module_has_its_names_on_first_use():
    assert pin.SE3.Identity().translation.tolist() == [0.0, 0.0, 0.0]
    assert callable(lapack.dgesv)
    assert callable(splines.BSpline)
    with pytest.raises(AttributeError):
        _ = pin.no_such_name
