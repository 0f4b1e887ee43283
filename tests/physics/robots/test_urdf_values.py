"""Values that no arm has: a run and the doctor refuse them in the same words."""

import pytest
from support import strangers
from support.strangers import Y, Z

from runner.base.errors import ConfigError
from runner.cli.main import dispatch
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel

ARM = strangers.chain("arm", [("revolute", Z), ("revolute", Y), ("revolute", Y)])


def changed(old, new):
    assert old in ARM
    return ARM.replace(old, new)


def joints(count):
    return strangers.chain("arm", [("revolute", (Z, Y)[i % 2]) for i in range(count)], length=0.02, mass=0.1)


FAULTS = {
    "mass": (changed('mass value="2.0"', 'mass value="1e300"'), "mass 1e+300 kg; allowed: 0, or 1e-12 to 1e+12"),
    "speck": (changed('mass value="2.0"', 'mass value="1e-30"'), "mass 1e-30 kg; allowed: 0, or 1e-12 to 1e+12"),
    "inertia": (changed('izz="0.0018', 'izz="1e30'), "inertia izz of 1e+30 kg m^2; allowed: up to 1e+12"),
    "place": (changed('<origin xyz="0 0 0.15"/>', '<origin xyz="nan 0 0"/>'), "<origin xyz='nan 0 0'>; allowed:"),
    "length": (changed('xyz="0 0 0.3"/><axis', 'xyz="0 0 1e300"/><axis'), "<origin xyz='0 0 1e300'>; allowed: three"),
    "axis": (changed(f'axis xyz="{Z}"', 'axis xyz="0 0 0"'), "an axis of length 0; give it a direction"),
    "effort": (changed('effort="2000"', 'effort="-1"'), "effort limit -1; allowed: 0 or more"),
    "still": (ARM.replace('type="revolute"', 'type="fixed"'), "no joint"),
    "65 joints": (joints(65), "65 joints that move; allowed: 1 to 64"),
    "200 joints": (joints(200), "200 joints that move; allowed: 1 to 64"),
    "link name": (changed('"l2"', f'"{"l" * 5000}"'), "the name of a link has 5000 characters, 'lll"),
    "joint name": (changed('"q2"', f'"{"q" * 2000}"'), "the name of a joint has 2000 characters, 'qqq"),
    "robot name": (changed('name="arm"', f'name="{"r" * 201}"'), "the name of a robot has 201 characters, 'rrr"),
    "deep": (changed("</robot>", "<a>" * 5000 + "</a>" * 5000 + "</robot>"), "stand 5001 deep within each other"),
    "links": (changed("</robot>", '<link name="x"/>' * 3000 + "</robot>"), "links and joints; allowed: up to 2,000"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_it_is_refused_in_words_by_run_and_doctor(tmp_path, capsys, fault):
    text, said = FAULTS[fault]
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    with pytest.raises(ConfigError) as raised:
        RobotModel(read_urdf(path, {}), "tip")
    assert said in str(raised.value)
    assert len(str(raised.value)) < 4000
    assert dispatch(["doctor", str(path)]) == 2
    printed = capsys.readouterr()
    assert said in printed.out + printed.err


LIMITS = {
    'lower="-2.8" upper="2.8"': ('lower="3" upper="-3"', "has limits from 3 to -3; lower must be below upper"),
    'lower="-2.8"': ('lower="low"', "has a limit lower='low'; allowed: a number"),
    'velocity="20"': ('velocity="nan"', "has a limit velocity='nan'; allowed: a number"),
}


def test_limits_that_the_doctor_mends_are_refused_by_a_run(tmp_path):
    path, all_of_them = tmp_path / "arm.urdf", ARM
    for old, (new, said) in LIMITS.items():
        path.write_text(changed(old, new))
        with pytest.raises(ConfigError) as raised:
            read_urdf(path, {})
        assert f"robot.urdf: joint 'q1' in {path} {said}" in raised.value.problems
        all_of_them = all_of_them.replace(old, new, 1)  # each at the first joint that still has it
    path.write_text(all_of_them)
    assert all(new in all_of_them for new, _ in LIMITS.values())
    assert dispatch(["doctor", str(path)]) == 0


@pytest.mark.bullet
def test_the_longest_names_and_the_most_joints_can_be_simulated(tmp_path):
    from runner.plants.bullet_engine import Bullet

    path = tmp_path / "arm.urdf"
    for text in (changed('"l2"', f'"{"l" * 200}"').replace('"q2"', f'"{"q" * 200}"'), joints(64)):
        path.write_text(text)
        urdf = read_urdf(path, {})
        model = RobotModel(urdf, "tip")
        plant = Bullet(urdf, model, 1e-3, 1)
        plant.advance(model.gravity_torque(plant.q))
        plant.close()
        assert abs(plant.dq).max() < 1e-6
