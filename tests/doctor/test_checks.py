"""Checks of the doctor: each fault of a robot file against the finding that it must give."""

import re

import numpy as np
import pytest
from support import strangers
from support.strangers import X, Y, Z

from runner.doctor import engines
from runner.doctor.examination import examine
from runner.doctor.finding import Finding, exit_code
from runner.engines import has_pybullet
from runner.errors import RunnerError
from runner.robots.inertials import impossible_inertia, mend_inertia
from runner.robots.tree import read_tree

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
    """What is said of a text at a place, as one line; the notes left out."""

    def make(text, place, tip=None):
        findings = examined(text, tip).findings
        (finding,) = [f for f in findings if f.place == place and f.grade != "note"]
        return finding

    return make


def changed(old, new):
    assert old in CLEAN
    return CLEAN.replace(old, new, 1)


def test_a_clean_arm_fits(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(CLEAN)
    examination = examine(path, None)
    assert [f.place for f in examination.findings].count("engines") == 2
    assert {f.grade for f in examination.findings} == {"note"}
    assert exit_code(examination.findings) == 0
    assert examination.tip == "tip"


@pytest.mark.parametrize(
    ("old", "new", "place", "said"),
    [
        ('mass value="2.0"', 'mass value="-2.0"', "link 'l1'", "mass -2 kg; allowed: 0 or more"),
        ('type="revolute"', 'type="floating"', "joint 'q1'", "it is floating; allowed: revolute, prismatic or fixed"),
        (
            'type="revolute"',
            'type="continuous"',
            "joint 'q1'",
            r"two coordinates \(nq = nv \+ 1\), PyBullet one",
        ),
        (
            'effort="2000"',
            'effort="0"',
            "joint 'q1'",
            "effort limit 0, with which it could not move; give .* N m",
        ),
        ('velocity="20"', "", "joint 'q1'", "no velocity limit; give that of the data sheet, in rad/s"),
        ('lower="-2.8"', 'lower="3"', "joint 'q1'", "limits from 3 to 2.8; give lower and upper, in rad"),
        ('xyz="0 0 0.3"/><axis', 'xyz="0 0 0,3"/><axis', "joint 'q2'", "xyz='0 0 0,3'>; allowed: three numbers"),
        (f'axis xyz="{Z}"', 'axis xyz="0 0 0"', "joint 'q1'", "an axis of length 0; give it a direction"),
    ],
)
def test_each_fault_is_named_with_its_mend(found, old, new, place, said):
    finding = found(changed(old, new), place)
    assert finding.mend
    assert re.search(said, str(finding))


def test_a_link_without_inertial_is_written_massless(examined):
    without = '<link name="tip"/>'
    start = CLEAN.index('<link name="tip">')
    text = CLEAN[:start] + without + CLEAN[CLEAN.index("</link>", start) + len("</link>") :]
    examination = examined(text)
    (finding,) = [f for f in examination.findings if f.grade == "finding"]
    assert str(finding).startswith("finding  link 'tip': no inertial: PyBullet makes it 1 kg")
    assert finding.mended
    assert examination.model.mass == pytest.approx(6.0)


@pytest.mark.parametrize("moments", [(0.1, 0.1, 0.3), (0.2, -0.1, 0.2), (1.0, 2.0, 3.5)])
def test_an_impossible_inertia_becomes_one_that_a_body_can_have(tmp_path, moments):
    values = " ".join(f'{key}="{value}"' for key, value in zip(("ixx", "iyy", "izz"), moments, strict=True))
    text = f'<robot name="x"><link name="a"><inertial><mass value="1"/><inertia {values} ixy="0.01" ixz="0" iyz="0"/>'
    (tmp_path / "x.urdf").write_text(text + "</inertial></link></robot>")
    link = read_tree(tmp_path / "x.urdf").links["a"]
    assert impossible_inertia(link)
    mend_inertia(link)
    assert impossible_inertia(link) == []
    mended = [float(link.find("inertial/inertia").get(key)) for key in ("ixx", "iyy", "izz")]
    assert np.abs(np.subtract(mended, moments)).max() < 0.6 * max(moments)


def test_what_moves_beside_the_way_is_held(examined):
    side = strangers.link("side", 1.0, 0.1) + strangers.joint(2, "prismatic", X, 0.1, (0, 0.04)).replace(
        'name="q3"', 'name="finger"'
    ).replace('<child link="l3"/>', '<child link="side"/>')
    text = CLEAN.replace("</robot>", side + "</robot>")
    with pytest.raises(RunnerError, match=r"arm branches, .* --tip FRAME, .*; ends: tip behind 3 of 4 joints; side"):
        examined(text)
    examination = examined(text, "tip")
    assert [str(f) for f in examination.findings if f.grade == "finding"] == [
        "finding  joint 'finger': it moves beside the way to the tip; hold it fixed at 0 m [--write does it]"
    ]
    assert examination.model.joint_names == ("q1", "q2", "q3")
    assert examination.model.mass == pytest.approx(7.0)


def test_a_mimicking_joint_bars_the_arm(found):
    text = CLEAN.replace('<child link="l2"/>', '<child link="l2"/><mimic joint="q1"/>')
    assert found(text, "joint 'q2'").text == "it mimics 'q1', and engines would let it move freely"


@pytest.mark.parametrize(
    ("mesh", "said"),
    [
        ("gone.stl", "no such file"),
        ("package://arm_description/meshes/gone.stl", "no such file"),
        ("../../secret.stl", "it leads out of"),
        ("/etc/passwd", "it leads out of"),
        ("package://arm_description/../../secret.stl", "it leads out of"),
    ],
)
def test_meshes_are_there_and_inside_the_folder(examined, mesh, said):
    shape = f'<visual><geometry><mesh filename="{mesh}"/></geometry></visual>'
    examination = examined(changed('<link name="l1">', f'<link name="l1">{shape}'))
    (finding,) = [f for f in examination.findings if f.grade == "refused"]
    assert said in finding.text
    assert examination.model is not None  # all else is still examined: runs need no mesh
    assert exit_code(examination.findings) == 2


def test_gravity_beyond_the_effort_limits(found):
    assert "its effort limit is 1 N m" in found(CLEAN.replace('effort="2000"', 'effort="1"'), "joint 'q2'").text


def test_joints_that_move_no_mass(examined):
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Y)], mass=0.0)
    examination = examined(text)
    assert "the mass matrix is singular" in next(f for f in examination.findings if f.grade == "refused").text
    assert examination.model is None


def test_a_tip_on_the_axes_stays_where_it_is(examined):
    text = strangers.chain("arm", [("revolute", Z), ("revolute", Z)], tip=(0.0, 0.0, 0.1))
    (finding,) = [f for f in examined(text).findings if f.grade == "refused"]
    assert "no joint moves 'tip' from its place" in finding.text


@pytest.mark.parametrize(("tip", "said"), [("tpi", r"did you mean tip\?"), ("l0", "no joint moves the link 'l0'")])
def test_a_tip_that_is_none(examined, tip, said):
    with pytest.raises(RunnerError, match=said):
        examined(CLEAN, tip)


def test_no_arm(examined):
    with pytest.raises(RunnerError, match="has no joint that moves: it is no arm"):
        examined('<robot name="x"><link name="a"/></robot>')
    assert exit_code(examined(strangers.chain("arm", [("revolute", X)])).findings) == 2  # one joint


# An arm that is read otherwise disagrees at every state: ten times as many are slow.
@pytest.mark.parametrize("samples", [100, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", strangers.STRANGERS)
def test_engines_agree_on_every_stranger_as_it_is_written(name, samples, monkeypatch):
    monkeypatch.setattr(engines, "_SAMPLES", samples)
    read = strangers.read(name)
    notes = engines.compare_engines(read.urdf, read.model, np.random.default_rng(0))
    assert [note.grade for note in notes] == ["note", "note"]
    assert ("of PyBullet and Pinocchio" if has_pybullet() else "PyBullet is not installed") in notes[0].text
    assert "of MuJoCo and Pinocchio" in notes[1].text


def test_lines_and_codes():
    grades = ["note", "finding", "refused"]
    findings = [Finding(grade, "link 'a'", "said", "do", True) for grade in grades]
    assert str(findings[0]) == "note     link 'a': said; do [--write does it]"
    assert [exit_code(findings[: n + 1]) for n in range(3)] == [0, 1, 2]
