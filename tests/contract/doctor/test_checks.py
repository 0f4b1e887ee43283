"""Checks of the doctor: each fault of a robot file against the finding that it must give."""

import re

import numpy as np
import pytest
from support import strangers
from support.strangers import X, Y, Z

from runner.base.engines import has_pybullet
from runner.base.errors import RunnerError
from runner.doctor import engines
from runner.doctor.examination import examine
from runner.doctor.finding import DoctorFinding, together

CLEAN = strangers.chain("arm", [("revolute", Z), ("revolute", Y), ("revolute", Y)])


@pytest.fixture
def examined(tmp_path):
    def make(text, tip=None):
        path = tmp_path / "arm.urdf"
        path.write_text(text)
        with strangers.short_examination():
            return examine(path, tip)

    return make


@pytest.fixture
def found(examined):
    """The finding on a string at a place, without the notes on other places."""

    def make(text, place, tip=None):
        (finding,) = [each for each in examined(text, tip).findings if each.place == place]
        return finding

    return make


def changed(old, new):
    assert old in CLEAN
    return CLEAN.replace(old, new, 1)


def grades(examination):
    return [each.grade for each in examination.findings]


def test_a_clean_arm_fits(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(CLEAN)
    examination = examine(path)
    assert [f.place for f in examination.findings].count("engines") == 2
    assert set(grades(examination)) == {"note"}
    assert (examination.tip, examination.arm.has_mass) == ("tip", True)


LIMIT = "the copy has 1e6, without limit"
TWICE = "now 1e6 rad to both sides: without limits"
EQUAL, FILLED = 'lower="-2.8" upper="2.8" effort="2000"', 'lower="0.5" upper="0.5" effort="2000"'


@pytest.mark.parametrize(
    ("old", "new", "place", "said"),
    [
        ('mass value="2.0"', 'mass value="-2.0"', "link 'l1'", "refused .*: mass -2 kg; allowed: 0 or more"),
        ('mass value="2.0"', 'mass value="4,0"', "link 'l1'", "refused .*: <mass value='4,0'>; allowed: a number of 0"),
        ('mass value="2.0"', "mass", "link 'l1'", "refused .*: a <mass> without value; write it, in kg"),
        ('type="revolute"', 'type="floating"', "joint 'q1'", "refused .* is floating; allowed: revolute, prismatic or"),
        ('type="revolute"', 'type="continuous"', "joint 'q1'", "fixed .* continuous; now revolute up to 1e6 rad"),
        (
            'effort="2000"',
            'effort="0"',
            "joint 'q1'",
            f"fixed .* effort limit 0: .* nothing drives it; {LIMIT}; write 0",
        ),
        ('effort="2000"', 'effort="-60"', "joint 'q1'", "refused .* effort limit -60; allowed: 0 or more"),
        ('velocity="20"', 'velocity="0"', "joint 'q1'", f"fixed .* velocity limit 0: .* stands still .*; {LIMIT}"),
        ('velocity="20"', "", "joint 'q1'", "note .* no velocity limit; give that of the data sheet"),
        ('lower="-2.8"', 'lower="3"', "joint 'q1'", "fixed .* from 3 to 2.8 rad; now exchanged: from 2.8 to 3"),
        (EQUAL, FILLED, "joint 'q1'", "fixed .* from 0.5 to 0.5 rad, which lock it; now a fixed joint at 0.5 rad"),
        (EQUAL, FILLED.replace("0.5", "1e6"), "joint 'q1'", f"fixed .* from 1e[+]06 to 1e[+]06 rad; {TWICE}"),
        ('lower="-2.8" upper="2.8"', "", "joint 'q1'", f"fixed .* no position limits; {TWICE}"),
        ('xyz="0 0 0.3"/><axis', 'xyz="0 0 0,3"/><axis', "joint 'q2'", "xyz='0 0 0,3'>; allowed: three numbers"),
        (f'axis xyz="{Z}"', 'axis xyz="0 0 0"', "joint 'q1'", "refused .* an axis of length 0; give it a direction"),
        (
            "</joint>",
            '<dynamics friction="-1.5"/></joint>',
            "joint 'q1'",
            "refused .*: <dynamics friction='-1.5'>; all",
        ),
        (
            "</joint>",
            '<dynamics damping="-2.5"/></joint>',
            "joint 'q1'",
            "note .* damping -2.5; it counts as 0; allowed",
        ),
        (' iyz="0"', "", "link 'l1'", "fixed .* no inertia iyz; now 0"),
    ],
)
def test_each_fault_is_named_with_what_was_or_can_be_done(found, old, new, place, said):
    if place == "link 'l1'":
        base, rest = CLEAN.split('<link name="l1">')
        text = base + '<link name="l1">' + rest.replace(old, new, 1)
    else:
        text = changed(old, new)
    assert re.search(said, str(found(text, place)))


def test_what_is_refused_leaves_no_arm_and_what_is_fixed_does(examined):
    assert examined(changed('type="revolute"', 'type="floating"')).arm is None
    fixed = examined(changed('effort="2000"', 'effort="0"'))
    assert fixed.arm.model.effort_limits[0] == np.inf
    assert 'effort="1000000.0"' in fixed.urdf


def test_a_locked_joint_stays_where_it_is_and_swapped_limits_are_exchanged(examined):
    locked = examined(changed(EQUAL, FILLED)).arm.model
    assert locked.joint_names == ("q2", "q3")
    free = examined(CLEAN).arm.model
    assert np.allclose(locked.tip_position(np.array([0.2, 0.4])), free.tip_position(np.array([0.5, 0.2, 0.4])))
    swapped = examined(changed('lower="-2.8" upper="2.8"', 'lower="2.7" upper="-2.9"')).arm.model
    assert swapped.position_limits[:, 0].tolist() == [-2.9, 2.7]


def test_limits_that_were_not_filled_in_are_no_lock(examined):
    empty = examined(changed(EQUAL, 'lower="0" upper="0" effort="0"'))
    said = [str(each) for each in empty.findings if each.place == "joint 'q1'"]
    assert said[0] == f"fixed   joint 'q1': limits from 0 to 0 rad, and no effort: not filled in; {TWICE}"
    assert empty.arm.model.nq == 3


def bare(*names):
    """The clean arm with links that have no <inertial>."""
    text = CLEAN
    for name in names:
        start = text.index(f'<link name="{name}">')
        text = text[:start] + f'<link name="{name}"/>' + text[text.index("</link>", start) + len("</link>") :]
    return text


def test_frames_without_mass_are_a_note_for_all_of_them(examined):
    examination = examined(bare("l0", "tip"))
    (note,) = [str(each) for each in examination.findings if "frame without mass" in each.text]
    assert note == "note    links 'l0', 'tip': no <inertial>: a frame without mass"
    assert set(grades(examination)) == {"note"}
    assert examination.arm.model.mass == pytest.approx(6.0)


@pytest.mark.parametrize(
    ("links", "why"),
    [
        (("l0", "l1", "l2", "l3", "tip"), "no link has a mass: torques cannot move it"),
        (("l3",), "no mass behind q3: torques cannot move it"),
        (("l2", "l3"), "no mass behind q2, q3: torques cannot move it"),
    ],
)
def test_an_arm_without_mass_has_its_kinematics(examined, links, why):
    examination = examined(bare(*links))
    (note,) = [each for each in examination.findings if each.place == "mass"]
    assert note.text.startswith(why)
    assert "give the links behind every joint <inertial>" in note.remedy
    assert not examination.arm.has_mass


def test_what_moves_beside_the_way_is_held(examined):
    side = strangers.link("side", 1.0, 0.1) + strangers.joint(0, "prismatic", X, 0.1, (0, 0.04)).replace(
        'name="q1"', 'name="slide"'
    ).replace('<child link="l1"/>', '<child link="side"/>')
    text = CLEAN.replace("</robot>", side + "</robot>")
    examination = examined(text)
    assert [str(each) for each in examination.findings if each.grade == "fixed"] == [
        "fixed   joint 'slide': moves, but not the tip; now held at 0 m"
    ]
    assert examination.arm.model.joint_names == ("q1", "q2", "q3")
    assert examination.arm.model.mass == pytest.approx(6.0)  # what is on the base does not move


def test_a_finger_that_mimics_is_held_without_its_mimic(examined):
    fingers = "".join(
        strangers.link(name, 0.1, 0.1)
        + strangers.joint(2, "prismatic", X, 0.1, (0.01, 0.04))
        .replace('name="q3"', f'name="{name}"')
        .replace('<child link="l3"/>', f'<child link="{name}"/>{mimic}')
        for name, mimic in (("f1", ""), ("f2", '<mimic joint="f1"/>'), ("f3", '<mimic joint="q2"/>'))
    )
    examination = examined(CLEAN.replace("</robot>", fingers + "</robot>"), "tip")
    beside, held = "moves, but not the tip", "now held at 0.01 m, its limit nearest to zero"
    follows = "which moves the tip: its links no longer move with that"
    assert [str(each) for each in examination.findings if each.grade == "fixed"] == [
        f"fixed   joint 'f1_joint': {beside}; {held}",
        f"fixed   joint 'f2_joint': {beside}, and mimics 'f1_joint'; now held at 0.01 m, as it mimics",
        f"fixed   joint 'f3_joint': {beside}, and mimics 'q2', {follows}; now held at 0 m",
    ]
    assert "mimic" not in examination.urdf
    assert examination.arm.model.joint_names == ("q1", "q2", "q3")


def test_a_finger_that_equal_limits_lock_is_held_there(examined):
    finger = strangers.joint(3, "prismatic", X, 0.1, (0.02, 0.02)).replace('<child link="l4"/>', '<child link="jaw"/>')
    text = CLEAN.replace("</robot>", strangers.link("jaw", 0.1, 0.1) + finger + "</robot>")
    said = [str(each) for each in examined(text, "tip").findings if each.grade == "fixed"]
    assert said == ["fixed   joint 'q4': moves, but not the tip; now held at 0.02 m, its limit nearest to zero"]


def test_a_mimicking_joint_on_the_way_bars_the_arm(found):
    text = CLEAN.replace('<child link="l2"/>', '<child link="l2"/><mimic joint="q1"/>')
    assert found(text, "joint 'q2'").text == "it moves the tip and mimics 'q1', and engines would let it move freely"


@pytest.mark.parametrize(
    ("mesh", "said"),
    [
        ("gone.stl", "1 of 1 not found: 'gone.stl'; runs need none"),
        ("package://arm_description/meshes/gone.stl", "not found: .*; --package-path DIR names .*; runs need none"),
        ("../../secret.stl", "outside of the folder of its URDF"),
        ("/etc/passwd", "outside of the folder of its URDF"),
        ("package://arm_description/../../secret.stl", "outside of the folder of its URDF or package"),
        (f"{'x' * 300}.stl", "1 of 1 not found"),
    ],
)
def test_meshes_that_are_not_there_or_lie_outside_are_a_note(examined, mesh, said):
    shape = f'<visual><geometry><mesh filename="{mesh}"/></geometry></visual>'
    examination = examined(changed('<link name="l1">', f'<link name="l1">{shape}'))
    notes = [str(each) for each in examination.findings if each.place == "meshes"]
    assert re.search(f"^note    meshes: .*{said}", notes[0])
    assert examination.arm is not None


def test_packages_lie_around_the_file_beside_it_or_where_it_is_told(tmp_path):
    for place in (
        "ws/arm_description/meshes",
        "ws/arm_description/urdf",
        "ws/hand_description",
        "far/tool_description",
    ):
        (tmp_path / place).mkdir(parents=True)
    meshes = ("arm_description/meshes/a.stl", "hand_description/b.stl", "tool_description/c.stl")
    for folder, mesh in zip(("ws", "ws", "far"), meshes, strict=True):
        (tmp_path / folder / mesh).write_text("solid")
    shapes = "".join(f'<visual><geometry><mesh filename="package://{mesh}"/></geometry></visual>' for mesh in meshes)
    path = tmp_path / "ws" / "arm_description" / "urdf" / "arm.urdf"
    path.write_text(changed('<link name="l1">', f'<link name="l1">{shapes}'))
    with strangers.short_examination():
        near, far = examine(path), examine(path, packages=[tmp_path / "far"])
    assert [each.text for each in near.findings if each.place == "meshes"] == [
        "1 of 3 not found: 'package://tool_description/c.stl'"
    ]
    assert not [each for each in far.findings if each.place == "meshes"]


def test_gravity_beyond_the_effort_limits(found):
    finding = found(CLEAN.replace('effort="2000"', 'effort="1"'), "joint 'q2'")
    assert finding.grade == "note"
    assert "its effort limit is 1 N m" in finding.text


def test_a_tip_on_the_axes_stays_where_it_is(examined):
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Z)], tip=(0.0, 0.0, 0.1))
    (finding,) = [f for f in examined(text).findings if f.grade == "refused"]
    assert "no joint moves 'tip' from its place" in finding.text


def test_fingers_and_jaws_are_no_joints_of_the_arm(examined):
    for names in (("left",), ("left", "right")):
        text = CLEAN
        for number, name in enumerate(names):
            finger = strangers.joint(3, "prismatic", X, 0.1, (0, 0.04)).replace('name="q4"', f'name="{name}_finger"')
            side = strangers.link(name, 0.1, 0.1) + finger.replace('<child link="l4"/>', f'<child link="{name}"/>')
            text = text.replace("</robot>", side + "</robot>")
            assert number < 2
        examination = examined(text)
        assert examination.tip == "tip"
        assert examination.arm.model.joint_names == ("q1", "q2", "q3")
        (note,) = [each.remedy for each in examination.findings if each.place == "tip"]
        told = ", ".join(f"{name} ({name}_finger)" for name in names)
        assert note == f"--tip takes another that the same joints move: l3; or one behind further joints: {told}"
        assert examined(text, "left").arm.model.nq == 4


@pytest.mark.parametrize(("tip", "said"), [("tpi", r"did you mean tip\?"), ("l0", "no joint moves the link 'l0'")])
def test_a_tip_that_is_none(examined, tip, said):
    with pytest.raises(RunnerError, match=said):
        examined(CLEAN, tip)


@pytest.mark.parametrize(
    ("names", "tip"),
    [(("flange", "tool0"), "tool0"), (("tool0", "flange"), "tool0"), (("palm", "hand_tcp"), "hand_tcp"),
     (("thumb_tip", "flange"), "flange"), (("a", "b"), "b")],
)  # fmt: skip
def test_the_tip_is_the_frame_that_is_called_so_else_the_farthest(examined, names, tip):
    text = CLEAN.replace('"tip"', '"end"')
    for parent, name in zip(("end", names[0]), names, strict=True):
        joint = f'<joint name="to_{name}" type="fixed"><parent link="{parent}"/><child link="{name}"/></joint>'
        text = text.replace("</robot>", f'<link name="{name}"/>{joint}</robot>')
    assert examined(text).tip == tip


def test_two_arms_are_refused_with_their_ends(examined):
    other = re.sub(r'"(l\d|q\d|tip|end)"', r'"r_\1"', CLEAN[CLEAN.index("<link") : CLEAN.index("</robot>")])
    both = CLEAN.replace("</robot>", f'{other}<joint name="both" type="fixed"><parent link="l0"/><child link="r_l0"/>'
                         "</joint></robot>")  # fmt: skip
    with pytest.raises(RunnerError, match=r"branches, .* --tip FRAME, .*; ends: tip behind 3 joints; r_tip behind 3"):
        examined(both)
    assert examined(both, "r_tip").arm.model.joint_names == ("r_q1", "r_q2", "r_q3")


def test_no_arm(examined):
    with pytest.raises(RunnerError, match="has no joint that moves: it is not an arm"):
        examined('<robot name="x"><link name="a"/></robot>')
    assert grades(examined(strangers.chain("arm", [("revolute", X)])))[0] == "refused"  # one joint


# An arm that is read otherwise disagrees at every state.
@pytest.mark.parametrize("name", strangers.STRANGERS)
def test_engines_agree_on_every_stranger_as_it_is_written(name):
    read = strangers.read(name)
    notes = engines.compare_engines(read.urdf, read.arm.model, np.random.default_rng(0))
    assert [note.grade for note in notes] == ["note", "note"]
    assert ("PyBullet and Pinocchio" if has_pybullet() else "PyBullet is not installed") in notes[0].text
    assert "MuJoCo and Pinocchio move it alike" in notes[1].text


def test_an_engine_that_reads_another_arm_is_refused():
    read = strangers.read("crane")
    heavier = read.urdf.replace('mass value="2.0"', 'mass value="2.01"')
    notes = engines.compare_engines(heavier, read.arm.model, np.random.default_rng(0))
    assert [note.grade for note in notes][-1] == "refused"
    assert "MuJoCo and Pinocchio move it differently" in notes[-1].text


def test_findings_of_the_same_words_are_one_and_refused_ones_come_first():
    said = [DoctorFinding("note", f"link '{name}'", "said", "do") for name in "ab"] + [
        DoctorFinding("refused", "tip", "said")
    ]
    assert list(map(str, together(said))) == ["refused tip: said", "note    links 'a', 'b': said; do"]


def test_inertias_and_masses_in_other_units_are_named(examined):
    assert [each for each in examined(CLEAN).findings if "Divide" in each.remedy] == []
    base, rest = CLEAN.split('<link name="l1">')
    scaled = re.sub(r'(i[xyz]{2})="([^"]*)"', lambda m: f'{m[1]}="{float(m[2]) * 1e6!r}"', rest, count=6)
    heavy = scaled.replace('mass value="2.0"', 'mass value="2000.0"').replace(
        'mass value="2000.0"', 'mass value="2.0"', 1
    )
    found = [str(each) for each in examined(f'{base}<link name="l1">{heavy}').findings if "Divide" in each.remedy]
    dense = "denser than metals; g? Divide the mass by 1000"
    assert found == [
        "note    link 'l1': a radius of gyration of 87 m on a link of 0.3 m; kg mm^2? Divide the inertia by 1e6",
        f"note    link 'l2': a mass of 2000 kg on a link of 0.3 m, {dense}",
        f"note    link 'l3': a mass of 2000 kg on a link of 0.25 m, {dense}",
    ]


@pytest.mark.parametrize(("limit", "named"), [(25.1, False), (25.2, True), (999.0, True), (1000.0, False)])
def test_limits_that_look_like_degrees_are_named(examined, limit, named):
    notes = [str(each) for each in examined(changed('upper="2.8"', f'upper="{limit}"')).findings]
    turns = f"a limit of {limit:g} rad, {limit / 6.2832:.0f} turns"
    said = f"note    joint 'q1': {turns}; degrees? Multiply the limits by pi/180"
    assert (said in notes) == named
    assert any("degrees" in note for note in notes) == named


@pytest.mark.parametrize(("length", "named"), [(24.0, False), (25.0, True)])
def test_lengths_that_look_like_millimetres_are_named(examined, length, named):
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Y), ("revolute", Y)], length=length, mass=2e8)
    notes = [str(each) for each in examined(text).findings if each.place == "lengths"]
    whole = 2.0 * length + 0.065**0.5
    assert (
        notes == [f"note    lengths: the joints lie {whole:.4g} m apart in sum; mm? Divide all lengths by 1000"] * named
    )


def test_the_effect_of_a_corrected_inertia_is_told(examined):
    base, rest = CLEAN.split('<link name="l3">')
    inertia = re.sub(r'izz="[^"]*"', 'izz="0.042"', rest, count=1)  # the others sum to 0.03
    findings = {each.place: str(each) for each in examined(f'{base}<link name="l3">{inertia}').findings}
    assert "which the largest is 40 % above" in findings["link 'l3'"]
    assert re.search(r"the corrected inertias change it by up to [\d.]+ %", findings["mass matrix"])
    assert "mass matrix" not in {each.place for each in examined(CLEAN).findings}


def test_several_arms_and_other_faults_are_told_at_once(examined):
    other = re.sub(r'"(l\d|q\d|tip|end)"', r'"r_\1"', CLEAN[CLEAN.index("<link") : CLEAN.index("</robot>")])
    both = CLEAN.replace("</robot>", f'{other}<joint name="both" type="fixed"><parent link="l0"/><child link="r_l0"/>'
                         "</joint></robot>")  # fmt: skip
    with pytest.raises(RunnerError, match=r"branches, (.|\n)*refused link 'l1': mass -2 kg"):
        examined(both.replace('mass value="2.0"', 'mass value="-2.0"', 1))


@pytest.mark.parametrize("value", ["round", "nan", "inf"])
def test_a_moment_that_is_not_a_finite_number_is_refused(found, value):
    text = re.sub(r'ixx="[^"]*"', f'ixx="{value}"', CLEAN, count=1)
    assert found(text, "link 'l0'").text == "an inertia that is not a finite number"
