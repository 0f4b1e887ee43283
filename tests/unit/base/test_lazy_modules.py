"""Libraries that checks of a config do without: they would take most of its time."""

import subprocess
import sys

import pytest

from runner.base.lazy_modules import lapack, pin, splines

CHECK = """
import sys
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.compose.problems import Problems
from runner.config.groups import read_groups

problems = Problems()
read_groups(compose(sys.argv[1:]).resolved, problems)
print(len(problems.found), "pinocchio" in sys.modules, "scipy" in sys.modules)
"""


@pytest.mark.parametrize(
    ("overrides", "problems"),
    [
        (["robot=macro", "controller=operational_space"], 0),
        (["robot=combined", "controller=macro_mini", "trajectory=waypoints"], 0),
        (["robot=macro", "controller=joint_pd", "controller.perid=5ms"], 1),
    ],
)
def test_groups_are_checked_without_rigid_body_models(overrides, problems):
    done = subprocess.run([sys.executable, "-c", CHECK, *overrides], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(problems), "False", "False"]


def test_a_module_has_its_names_on_first_use():
    assert pin.SE3.Identity().translation.tolist() == [0.0, 0.0, 0.0]
    assert callable(lapack.dgesv)
    assert callable(splines.BSpline)
    with pytest.raises(AttributeError):
        _ = pin.no_such_name
