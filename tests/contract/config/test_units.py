"""Values with units: numbers in SI against the units typed, by stage, axis and file."""

import copy
import math

import pytest
from support import strangers

from runner.assembly.validation import validate
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.compose.units import as_numbers, to_si, with_numbers
from runner.store import run_hash

MACRO = ("robot=macro", "trajectory=quintic")


def problems(*overrides, config_dirs=()):
    composed = compose(overrides, config_dirs)
    with pytest.raises(ConfigError) as caught:
        validate(composed)
    return caught.value.problems


@pytest.mark.parametrize(
    ("typed", "number"),
    [
        ("controller.period=20ms", "controller.period=0.02"),
        ("duration=0.5s", "duration=0.5"),
        ("robot.home=[0,-30deg,90 deg]", f"robot.home=[0,{math.radians(-30)!r},{math.pi / 2!r}]"),
        ("noise.position=1mrad", "noise.position=0.001"),
        ("robot.goal=[500mm,50cm,1.2m]", "robot.goal=[0.5,0.5,1.2]"),
        ("robot.payload.mass=250g", "robot.payload.mass=0.25"),
        ("torque_limits.max=[1kN m,200N m,3]", "torque_limits.max=[1000.0,200.0,3]"),
        ("plant.friction.coulomb=1Nm", "plant.friction.coulomb=1.0"),
        ("controller.natural_frequency=30rpm", f"controller.natural_frequency={math.pi!r}"),
        ("robot.masses={link1: 500g}", "robot.masses={link1: 0.5}"),
        ("robot.period=30ms", "robot.period=0.03"),  # which the controller's refers to
        ("wrist_sensor.bias=[1N,0,0,0,5mN m,0]", "wrist_sensor.bias=[1.0,0,0,0,0.005,0]"),
        ("caveats.joint_limits.excess=1deg", f"caveats.joint_limits.excess={math.pi / 180!r}"),
        ("gravity='9810mm/s^2'", "gravity=9.81"),
    ],
)
def test_a_quantity_is_its_number_in_si(typed, number):
    with_unit, plain = compose([*MACRO, typed]).resolved, compose([*MACRO, number]).resolved
    assert with_unit == plain
    assert run_hash(with_unit, "") == run_hash(plain, "")


def test_by_stage_and_in_nested_groups():
    resolved = compose(["robot=combined", "controller.period.macro=30ms", "noise.position.mini=0.1deg"]).resolved
    assert resolved["controller"]["period"]["macro"] == 0.03
    assert resolved["noise"]["position"]["mini"] == pytest.approx(math.radians(0.1))
    mounted = compose(["robot=combined", "robot.stages.mini.mount.translation=[0,0,5mm]"]).resolved
    assert mounted["robot"]["stages"]["mini"]["mount"]["translation"][2] == 0.005


def test_in_a_yaml_file_of_ones_own(tmp_path):
    (tmp_path / "noise").mkdir()
    (tmp_path / "noise" / "mine.yaml").write_text(
        "position: 0.1deg\ndistribution: uniform\nbias: 1 mrad\nvelocity: exact\n"
    )
    noise = compose([*MACRO, "noise=mine"], [tmp_path]).resolved["noise"]
    assert (noise["position"], noise["bias"]) == (pytest.approx(math.radians(0.1)), 0.001)


def test_an_axis_about_which_something_turns_has_the_other_unit():
    common = ("robot=xarm7", "controller=admittance")
    mass = compose([*common, "controller.mass=[1000g,1,1,'100kg cm^2',1,1]"]).resolved["controller"]["mass"]
    assert mass == [1.0, 1, 1, 0.01, 1, 1]
    assert any("controller.mass.3: must be a number, or one with a unit of kg m^2" in problem
               for problem in problems(*common, "controller.mass=[1,1,1,1kg,1,1]"))  # fmt: skip


def test_of_a_calibration():
    typed = compose(["calibration=gravity", "calibration.spread=30deg"], root="calibrate").resolved
    assert typed["calibration"]["spread"] == math.radians(30)


def test_of_a_plug_in_that_declares_its_units(own_part):
    module = """
        from typing import Literal
        from runner.plugins.registry import StrictModel
        from runner.schema.units import Seconds
        class CONFIG(StrictModel):
            kind: Literal["waiting"]
            settle: Seconds[float]
            share: float
        def build(config, start):
            return None
    """
    folder = own_part("trajectory", "waiting", module, "settle: 1.0\nshare: 0.5\n")
    told = compose(["robot=macro", "trajectory=waiting", "trajectory.settle=20ms"], [folder]).resolved
    assert told["trajectory"]["settle"] == 0.02
    assert problems("robot=macro", "trajectory=waiting", "trajectory.share=5mm", config_dirs=[folder]) == (
        "trajectory.share: has no unit; found '5mm'; write only the number",
    )


@pytest.mark.parametrize(
    ("override", "problem"),
    [
        ("controller.period=5mm", "controller.period: must be a number, or one with a unit of s (written s, ms, us, "
         "ns, min, h); found '5mm'"),
        ("controller.period=5msec", "controller.period: must be a number, or one with a unit of s (written s, ms, us, "
         "ns, min, h); found '5msec'; 'msec' is not a unit (did you mean ms?)"),
        ("controller.damping_ratio=1mm", "controller.damping_ratio: has no unit; found '1mm'; write only the "
         "number"),
        ("repetitions=5ms", "repetitions: has no unit; found '5ms'; write only the number"),
        ("robot.home=[0,5kg,0]", "robot.home.1: must be a number, or one with a unit of rad (written rad, mrad, deg) "
         "or m (written m, cm, mm, um); found '5kg'"),
        ("torque_limits.max=5Nms", "torque_limits.max: must be a number, or one with a unit of N m (written N m, mN m, "
         "kN m) or N (written N, mN, kN); found '5Nms'; 'Nms' is not a unit (did you mean ms?)"),
        ("controller.period=-5ms", "controller.period: must be above 0; found -0.005"),
    ],
)  # fmt: skip
def test_a_wrong_unit_is_one_problem_that_names_the_right_ones(override, problem):
    assert problems(*MACRO, override) == (problem,)


def test_a_name_that_looks_like_a_quantity_stays(tmp_path):
    assert compose([*MACRO, "robot.name=6m"]).resolved["robot"]["name"] == "6m"


def test_a_joint_that_slides_takes_lengths_and_one_that_turns_angles():
    folder = strangers.folder()
    assert [strangers.robot(name) for name in ("crane", "gantry")] == ["crane", "gantry"]
    home = compose(["robot=crane", "robot.home=[10deg,-20deg,50mm]"], [folder]).resolved["robot"]["home"]
    assert home == [math.radians(10), math.radians(-20), 0.05]
    allowed = "write rad for revolute joints, m for prismatic ones, a number without unit for both"
    for override, problem in (
        ("robot.home=[10mm,0,0]", "robot.home.0: '10mm' has a unit of prismatic joints, and sets a revolute joint; "),
        ("robot.home=[0,0,5deg]", "robot.home.2: '5deg' has a unit of revolute joints, and sets a prismatic joint; "),
    ):
        assert problems("robot=crane", override, config_dirs=[folder]) == (problem + allowed,)
    # One value for joints of both kinds has no unit.
    (problem,) = problems("robot=crane", "noise.position=1mrad", config_dirs=[folder])
    assert problem == f"noise.position: '1mrad' has a unit of revolute joints, and sets a prismatic joint; {allowed}"
    gantry = compose(["robot=gantry", "noise.position=1mm"], [folder]).resolved
    assert gantry["noise"]["position"] == 0.001


def test_a_config_of_numbers_is_left_as_it_is():
    resolved = compose(MACRO).resolved
    before = copy.deepcopy(resolved)
    to_si(resolved)
    assert resolved == before


def test_values_of_an_axis():
    assert as_numbers(["5ms", "10ms", 0.02], "controller.period") == [0.005, 0.01, 0.02]
    assert as_numbers([0.005, 0.01], "controller.period") is None  # nothing to do
    assert as_numbers(["5ms", "5mm"], "controller.period") is None
    assert as_numbers(["1mrad", "1mm"], "noise.position") is None  # a joint turns or slides
    assert as_numbers(["macro", "mini"], "robot.name") is None


def test_quantities_in_ranges():
    assert with_numbers("controller.period=interval(5ms, 50ms)") == "controller.period=interval(0.005,0.05)"
    assert with_numbers("++controller.period=tag(log,interval(5ms,0.05))") == (
        "++controller.period=tag(log,interval(0.005,0.05))"
    )
    assert with_numbers("a=range(0,10,step=2)") == "a=range(0,10,step=2)"
    assert with_numbers("duration=range(start=1s,stop=3s)") == "duration=range(start=1.0,stop=3.0)"
    with pytest.raises(ConfigError, match=r"controller\.period: must be a number, or one with a unit of s .* '5mm'"):
        with_numbers("controller.period=interval(5mm,50ms)")


@pytest.mark.parametrize(
    ("typed", "key", "found"),
    [
        ("duration=1", "duration", 1.0),
        ("robot.home=[0,1,2.5]", "robot.home", [0.0, 1.0, 2.5]),
        ("torque_limits.max=40", "torque_limits.max", 40.0),
        ("robot.masses={link1:2}", "robot.masses.link1", 2.0),
        ("noise.position={macro:1,mini:0}", "noise.position.mini", 0.0),
        ("repetitions=2", "repetitions", 2),
        ("seed=3", "seed", 3),
        ("plant.computation.delay=1", "plant.computation.delay", 1),
        ("duration=true", "duration", True),
        ("duration=1000000000000000000000", "duration", 10**21),
        ("nothing.of.this=1", "nothing.of.this", 1),
    ],
)
def test_integers_of_float_keys_are_floats(typed, key, found):
    assert repr(get(compose([*MACRO, typed]).resolved, key)) == repr(found)
