"""Robot files: where they are found, and masses and limits from a config against the model."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.base.paths import robots_dir
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel

MASS = '<mass value="{m}"/>'
INERTIA = '<inertia ixx="{i}" ixy="0.01" ixz="0" iyy="{i}" iyz="0" izz="{i}"/>'
LIMITS = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'


def robot(hand, base="<inertial><mass value='0'/></inertial>"):
    return (
        f'<robot name="one"><link name="base">{base}</link><link name="hand">{hand}</link><joint name="turn" '
        f'type="revolute"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>{LIMITS}</joint></robot>'
    )


def inertial(m, i=0.5):
    return f"<inertial>{MASS.format(m=m)}{INERTIA.format(i=i)}</inertial>"


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "arm.urdf"
        path.write_text(text)
        return path

    return write


def inertials(urdf):
    """Mass and inertia of each link."""
    return {
        link.get("name"): (
            float(link.find("inertial/mass").get("value")),
            {key: float(value) for key, value in link.find("inertial/inertia").attrib.items()},
        )
        for link in ET.fromstring(urdf).iter("link")
        if link.find("inertial/inertia") is not None
    }


@pytest.mark.parametrize("name", ["macro.urdf", "mini.urdf"])
def test_our_robots_are_found_by_name(name):
    assert find_urdf(name) == robots_dir() / name


def test_the_user_s_folders_come_before_ours(tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    for folder in (first, second, second / "robots"):
        folder.mkdir()
    for place in (second / "macro.urdf", second / "robots" / "macro.urdf"):
        place.write_text("x")
    assert find_urdf("macro.urdf", [first, second]) == second / "robots" / "macro.urdf"
    (first / "macro.urdf").write_text("x")
    assert find_urdf("macro.urdf", [first, second]) == first / "macro.urdf"
    assert find_urdf("mini.urdf", [first, second]) == robots_dir() / "mini.urdf"


def test_an_absolute_path_is_taken_as_it_is(written):
    path = written("x")
    assert find_urdf(str(path)) == path


def test_a_file_that_is_nowhere(tmp_path):
    with pytest.raises(ConfigError) as caught:
        find_urdf("marco.urdf", [tmp_path])
    text = str(caught.value)
    assert "robot.urdf: no file 'marco.urdf' (did you mean macro.urdf?)" in text
    for place in (tmp_path, tmp_path / "robots", robots_dir(), "macro.urdf, meca500.urdf, mini.urdf"):
        assert str(place) in text


@pytest.mark.parametrize("name", ["../arm.urdf", "arms/../../arm.urdf"])
def test_a_name_that_leads_out_of_its_folder_is_refused_though_the_file_exists(tmp_path, name):
    (tmp_path / "mine" / "arms").mkdir(parents=True)
    (tmp_path / "arm.urdf").write_text("<robot/>")
    with pytest.raises(ConfigError, match=r"robot\.urdf: '.*' leads out of its folder; put the file there"):
        find_urdf(name, [tmp_path / "mine"])


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_without_masses_nothing_changes(name):
    path = find_urdf(f"{name}.urdf")
    assert inertials(read_urdf(path, {})) == inertials(path.read_text())


def test_masses_are_applied_and_inertias_scaled_along(written):
    path = written(robot(inertial(2.0)))
    mass, inertia = inertials(read_urdf(path, {"hand": 5.0}))["hand"]
    assert mass == 5.0
    expected = {"ixx": 1.25, "ixy": 0.025, "ixz": 0.0, "iyy": 1.25, "iyz": 0.0, "izz": 1.25}
    assert inertia == pytest.approx(expected)
    assert inertials(path.read_text())["hand"][0] == 2.0  # the file keeps its own


def test_masses_reach_the_model_and_leave_other_links_alone():
    path = find_urdf("macro.urdf")
    base, heavy = (RobotModel(read_urdf(path, masses), "tip") for masses in ({}, {"link3": 3.0}))
    q = np.array([0.1, 0.2, 0.3])
    expected = base.gravity_torque(q) + 2.0 * 9.81 * base.tip_jacobian(q)[2]  # two kilograms more at the tip
    np.testing.assert_allclose(heavy.gravity_torque(q), expected, rtol=1e-12)


def test_a_mass_is_kept_to_the_last_bit(written):
    mass = 0.1 + 0.2
    assert inertials(read_urdf(written(robot(inertial(2.0))), {"hand": mass}))["hand"][0] == mass


@pytest.mark.bullet
@pytest.mark.parametrize("hand", ["", "<visual/>"])
def test_a_frame_without_inertial_is_massless_in_every_engine(written, hand):
    urdf = read_urdf(written(robot(hand)), {})
    assert inertials(urdf)["hand"] == (0.0, dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 0.0))
    with pytest.raises(ConfigError, match=r"'hand' is massless in arm\.urdf; its mass cannot be scaled"):
        read_urdf(written(robot(hand)), {"hand": 1.0})


def test_an_inertial_without_mass_is_refused(written):
    with pytest.raises(ConfigError, match=r"link 'hand' in .* has an <inertial> without <mass>: write its mass"):
        read_urdf(written(robot("<inertial/>")), {})


def test_a_mass_without_inertia_is_refused_as_pinocchio_would_leave_it_out(written):
    with pytest.raises(
        ConfigError, match=r"link 'hand' in .* has no <inertia>, and Pinocchio would leave its mass out"
    ):
        read_urdf(written(robot("<inertial><mass value='2'/></inertial>")), {})
    partly = "<inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='1'/></inertial>"
    with pytest.raises(ConfigError, match=r"link 'hand' in .* has inertia ixy that is missing or no finite number"):
        read_urdf(written(robot(partly)), {})


def test_no_mass_needs_no_inertia(written):
    urdf = read_urdf(written(robot(inertial(2.0))), {})  # the base says neither
    assert set(inertials(urdf)["base"][1].values()) == {0.0}
    assert RobotModel(urdf, "hand").mass == 2.0


@pytest.mark.parametrize("mass", ["-1", "nan", "inf", "heavy", ""])
def test_a_mass_in_the_file_is_a_number_of_0_or_more(written, mass):
    with pytest.raises(ConfigError, match=r"link 'hand' in .* has <?mass .*; allowed: .*0 or more"):
        read_urdf(written(robot(inertial(mass))), {})


def test_an_unknown_link_is_named_with_the_nearest():
    with pytest.raises(
        ConfigError, match=r"robot\.masses\.lnk3: no such link \(did you mean link3\?\); links: base, li"
    ):
        read_urdf(find_urdf("macro.urdf"), {"lnk3": 1.0})


def test_a_massless_link_cannot_be_scaled():
    with pytest.raises(ConfigError, match=r"robot\.masses\.tip: link 'tip' is massless in macro\.urdf"):
        read_urdf(find_urdf("macro.urdf"), {"tip": 1.0})


def test_an_inertia_that_is_no_number_cannot_be_scaled(written):
    with pytest.raises(ConfigError, match=r"robot\.urdf: link 'hand' .* ixx"):
        read_urdf(written(robot(inertial(2.0, "round"))), {"hand": 1.0})


def test_velocity_limits_are_applied_to_the_joints_named():
    path = find_urdf("xarm7.urdf")
    limits = RobotModel(read_urdf(path, {}, velocity_limits={"joint2": 2.14}), "flange").velocity_limits
    np.testing.assert_array_equal(limits, [3.141593, 2.14, *[3.141593] * 5])


def test_an_unknown_joint_is_named_with_the_nearest():
    with pytest.raises(
        ConfigError, match=r"robot\.velocity_limits\.jiont2: no such joint \(did you mean joint2\?\); j"
    ):
        read_urdf(find_urdf("xarm7.urdf"), {}, velocity_limits={"jiont2": 2.14})


def test_all_problems_at_once():
    with pytest.raises(ConfigError) as caught:
        read_urdf(find_urdf("macro.urdf"), {"lnk3": 1.0, "tip": 1.0, "link2": 1.0})
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize("text", ["", "not xml", "<robot>", "<robot><link></robot>"])
def test_what_is_no_xml(written, text):
    with pytest.raises(ConfigError, match=r"robot\.urdf: .*arm\.urdf is not XML"):
        read_urdf(written(text), {})


@pytest.mark.parametrize("text", ["<sdf/>", "<robot name='x'/>", "<html><link name='a'/></html>"])
def test_what_is_no_urdf(written, text):
    with pytest.raises(ConfigError, match=r"robot\.urdf: .*arm\.urdf is not a URDF"):
        read_urdf(written(text), {})


def test_what_is_no_text(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_bytes(b"\xff\xfe\x00binary")
    with pytest.raises(ConfigError, match=r"arm\.urdf is not XML"):
        read_urdf(path, {})
