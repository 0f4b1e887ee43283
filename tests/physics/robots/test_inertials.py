"""Sets of inertials and payloads against the masses of the model; bad sets are refused."""

import numpy as np
import pytest
import yaml

from runner.base.errors import ConfigError
from runner.robots.description import find_urdf, read_urdf, with_payloads
from runner.robots.inertials import Payload, set_file
from runner.robots.model import RobotModel

TENSOR = {"ixx": 0.2, "ixy": 0.0, "ixz": 0.0, "iyy": 0.3, "iyz": 0.0, "izz": 0.4}
HAND = {"mass": 3.0, "centre_of_mass": [0.1, 0.0, 0.2], "inertia": TENSOR}
URDF = """<robot name="one"><link name="base"><inertial><mass value="0"/></inertial></link>
<link name="hand"><inertial><origin xyz="0.5 0.2 0.1" rpy="0.3 -0.4 0.9"/><mass value="2"/>
<inertia ixx="0.10" ixy="0.01" ixz="0.02" iyy="0.11" iyz="0.03" izz="0.12"/></inertial></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="hand"/><axis xyz="0 0.6 0.8"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""


@pytest.fixture
def arm(tmp_path):
    """Write a URDF and its sets, and return the file."""

    def write(sets=None):
        path = tmp_path / "arm.urdf"
        path.write_text(URDF)
        if sets is not None:
            set_file(path).write_text(sets if isinstance(sets, str) else yaml.safe_dump(sets))
        return path

    return write


def one_set(hand=HAND, link="hand"):
    return {"other": {"source": "made up", "links": {link: hand}}}


def test_a_set_comes_in_place_of_the_file_s_own(arm):
    model = RobotModel(read_urdf(arm(one_set()), {}, inertials="other"), "hand")
    inertia = model.pin_model.inertias[1]
    assert inertia.mass == 3.0
    np.testing.assert_array_equal(inertia.lever, [0.1, 0.0, 0.2])
    np.testing.assert_array_equal(inertia.inertia, np.diag([0.2, 0.3, 0.4]))  # the file's own frame is gone


def test_masses_scale_the_set_s(arm):
    model = RobotModel(read_urdf(arm(one_set()), {"hand": 6.0}, inertials="other"), "hand")
    np.testing.assert_allclose(model.pin_model.inertias[1].inertia, np.diag([0.4, 0.6, 0.8]), rtol=1e-15)


@pytest.mark.parametrize(("name", "own"), [("xarm7", "type7_HT_BR2"), ("meca500", "cad_closed")])
def test_the_urdf_s_own_set_can_be_named(name, own):
    path = find_urdf(f"{name}.urdf")
    assert read_urdf(path, {}, inertials=own) == read_urdf(path, {})


def test_an_unknown_set_lists_what_there_is():
    with pytest.raises(ConfigError, match=r"no set 'type7_HT_L' \(did you mean type7_HT_LD\?\); sets: type7_HT_BR2, "):
        read_urdf(find_urdf("xarm7.urdf"), {}, inertials="type7_HT_L")


def test_an_arm_without_sets_says_so(arm):
    with pytest.raises(ConfigError, match=r"no set 'other'; there is no arm\.inertials\.yaml; allowed: null"):
        read_urdf(arm(), {}, inertials="other")


def test_a_set_with_an_inertia_that_no_body_has_is_named(arm):
    tensor = {**TENSOR, "ixx": 5.0}
    path = arm(one_set({**HAND, "inertia": tensor}))
    with pytest.raises(ConfigError) as raised:
        read_urdf(path, {}, inertials="other")
    assert f"robot.inertials: set 'other' in {set_file(path)} gives link 'hand' principal moments" in str(raised.value)
    read_urdf(path, {})  # the file's own are sound


def test_a_set_for_a_strange_link_is_refused(arm):
    with pytest.raises(ConfigError, match=r"set 'other' names the link 'hnad', which arm\.urdf .*did you mean hand"):
        read_urdf(arm(one_set(link="hnad")), {}, inertials="other")


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"mass": -1.0}, r"other\.links\.hand\.mass: .* found -1\.0"),
        ({"mass": float("nan")}, r"other\.links\.hand\.mass: .*finite"),
        ({"centre_of_mass": [0.0, 0.0]}, r"other\.links\.hand\.centre_of_mass"),
        ({"weight": 1.0}, r"other\.links\.hand\.weight"),
        ({"inertia": {**TENSOR, "izz": "heavy"}}, r"other\.links\.hand\.inertia\.izz: .* found 'heavy'"),
    ],
)
def test_a_bad_set_says_where(arm, change, problem):
    with pytest.raises(ConfigError, match=problem):
        read_urdf(arm(one_set({**HAND, **change})), {}, inertials="other")


@pytest.mark.parametrize(
    "text",
    ["a: [", "", "- 1", "a: " + "[" * 50_000, "a: &a [*a]"],
    ids=["open list", "empty", "list", "deep list", "list in itself"],
)
def test_a_set_file_that_is_none(arm, text):
    with pytest.raises(ConfigError, match=r"robot\.inertials: .*arm\.inertials\.yaml"):
        read_urdf(arm(text), {}, inertials="other")


def test_a_payload_merges_with_the_inertial_that_is_there(arm):
    path, place = arm(), np.array([-0.3, 0.1, 0.7])
    plain, loaded = (
        RobotModel(with_payloads(read_urdf(path, {}), payloads), "hand")
        for payloads in ([], [Payload("hand", 1.5, place)])
    )
    before, after = plain.pin_model.inertias[1], loaded.pin_model.inertias[1]
    assert after.mass == pytest.approx(3.5, rel=1e-15)
    np.testing.assert_allclose(after.lever, (2.0 * before.lever + 1.5 * place) / 3.5, rtol=1e-14)
    apart = before.lever - place  # two bodies about their common centre: the reduced mass at their distance
    steiner = 2.0 * 1.5 / 3.5 * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    np.testing.assert_allclose(after.inertia, before.inertia + steiner, rtol=0, atol=1e-14)


def test_no_payload_changes_nothing(arm):
    path = arm()
    assert with_payloads(read_urdf(path, {}), [Payload("hand", 0.0, (0.1, 0.2, 0.3))]) == read_urdf(path, {})


def test_a_payload_needs_a_link(arm):
    with pytest.raises(ConfigError, match=r"robot\.payload: the tip frame 'turn' is not a link; .* Links: base, hand"):
        with_payloads(read_urdf(arm(), {}), [Payload("turn", 1.0, (0.0, 0.0, 0.0))])
