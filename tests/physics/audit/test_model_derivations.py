"""Reference derivations of models: right for every built-in robot, and enough for a folder of only YAML."""

import numpy as np
import pytest

from runner.base.errors import RunnerError
from runner.base.paths import conf_dir
from runner.papers.audit.audit import audit
from runner.papers.audit.entry import entries
from runner.papers.audit.model_derivations import DERIVATIONS, audited_arm, sample
from runner.papers.audit.sources import Source, consequence_of, derivation_of
from runner.papers.audit.verdict import AuditError

ROBOTS = sorted(path.stem for path in (conf_dir() / "robot").glob("*.yaml"))

TWO_LINKS = """
<robot name="two">
  <link name="base"/><link name="upper"/><link name="lower"/><link name="tip"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <joint name="b" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.5 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <joint name="c" type="fixed"><parent link="lower"/><child link="tip"/><origin xyz="0.3 0 0"/></joint>
</robot>
"""
PAPER = """
robot: two.urdf
joints: [theta1, theta2]
symbols: {l1: 0.5, l2: 0.3, s12: sin(theta1 + theta2), c12: cos(theta1 + theta2)}
entries:
- id: paper-3
  number: (3)
  place: Kinematics
  title: Second column
  printed: {elements: {J_12: -l2*s12, J_22: l2*c12, J_62: 1}}
  derivation: model.jacobian
- id: paper-4
  number: (4)
  place: Kinematics
  title: First column
  printed: {elements: {J_11: -l1*s1 - l2*s2}}
  corrected: {elements: {J_11: -l1*s1 - l2*s12}}
  derivation: model.linear_jacobian
- id: paper-5
  number: (5)
  place: Kinematics
  title: Elbow
  printed: {elements: {P_x: l1*c1, P_y: l1*s1, P_z: 0}}
  derivation: model.position
  tip: lower
"""


@pytest.fixture
def paper(tmp_path):
    """A user's folder: a URDF, one YAML file."""

    def write(text=PAPER):
        (tmp_path / "equations").mkdir(exist_ok=True)
        (tmp_path / "equations" / "1.yaml").write_text(text)
        (tmp_path / "two.urdf").write_text(TWO_LINKS)
        return tmp_path

    return write


@pytest.mark.parametrize("robot", ROBOTS)
def test_both_ways_agree_on_every_robot(robot, tmp_path):
    arm = audited_arm(robot, "", (), tmp_path)
    values = sample(arm.model, arm.joints, 20, np.random.default_rng(1))
    for name in DERIVATIONS:
        found = arm.derivations(name)
        first, second = found.first(values), found.second(values)
        assert set(first) == set(second)
        for element, expected in first.items():
            np.testing.assert_allclose(second[element], expected, atol=1e-9, err_msg=f"{name}, {element}")


def test_joints_that_slide_and_axes_that_lean(tmp_path):
    (tmp_path / "slide.urdf").write_text(
        TWO_LINKS.replace('name="b" type="revolute"', 'name="b" type="prismatic"')
        .replace('<axis xyz="0 0 1"/>\n', '<axis xyz="1 2 -2"/>\n')
        .replace('<origin xyz="0.5 0 0"/>', '<origin xyz="0.5 0 0" rpy="0.1 0.2 0.3"/>')
        .replace('<link name="lower"/>', '<link name="lower"><inertial><origin xyz="0.1 0 0.2" rpy="0.5 0 1"/>'
                 '<mass value="2"/><inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.2" iyz="0.02" izz="0.15"/>'
                 "</inertial></link>")
    )  # fmt: skip
    arm = audited_arm("slide.urdf", "", (), tmp_path)
    assert arm.model.prismatic.tolist() == [False, True]
    values = sample(arm.model, arm.joints, 20, np.random.default_rng(1))
    for name in DERIVATIONS:
        for element, expected in arm.derivations(name).first(values).items():
            np.testing.assert_allclose(arm.derivations(name).second(values)[element], expected, atol=1e-9)


def test_a_folder_of_yaml_alone_is_audited(paper):
    right, wrong, elbow = audit(paper(), samples=200)
    assert [each.verdict for each in (right, wrong, elbow)] == ["correct", "wrong as printed", "correct"]
    assert wrong.measured.largest == pytest.approx(0.6, rel=0.05)
    assert wrong.second.largest == pytest.approx(wrong.measured.largest, rel=1e-9)
    assert right.methods[0] == "Pinocchio"
    assert right.source == paper().name


def test_a_wrong_entry_needs_its_correction(paper):
    changed = PAPER.replace("  corrected: {elements: {J_11: -l1*s1 - l2*s12}}\n", "")
    with pytest.raises(AuditError, match=r"1.yaml, line \d+: paper-4: is wrong by .* and has no correction"):
        audit(paper(changed))


def test_a_robot_of_ours_by_name(paper):
    text = """
robot: macro
entries:
- {id: G, number: '1', place: p, title: t, derivation: model.gravity, printed: {elements: {G_3: -9.81*sin(q2 + q3)}}}
- {id: V, number: '2', place: p, title: t, derivation: model.coriolis,
   printed: {elements: {C_33: 0, B_13: 2*dq1 - 2*dq1}}, corrected: {elements: {C_33: 0, B_13: 0}}}
"""
    with pytest.raises(AuditError, match="is corrected, but its verdict is 'correct'"):
        audit(paper(text))
    assert audit(paper(text.partition("- {id: V")[0]))[0].verdict == "correct"


def test_a_robot_of_the_folder_by_its_config(paper):
    text = "robot: mine\nentries:\n- {id: G, number: '1', place: p, title: t, derivation: model.gravity, printed: FORM}"
    folder = paper(text.replace("FORM", "{elements: {G_3: -4*9.81*sin(q2 + q3)}}"))
    (folder / "robot").mkdir()
    config = (conf_dir() / "robot" / "macro.yaml").read_text()
    (folder / "robot" / "mine.yaml").write_text(config.replace("name: macro", "name: mine").replace("3: 1.0", "3: 4.0"))
    assert [each.verdict for each in audit(folder, samples=20)] == ["correct"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("model.position", "model.positon", r"1.yaml, line \d+: paper-5: no derivation 'model.positon' \(did you"),
        ("tip: lower", "tip: lowr", r"1.yaml, line \d+: paper-5: robot.tip: no frame 'lowr' \(did you mean lower\?\)"),
        ("robot: two.urdf", "robot: two_.urdf", r"1.yaml, line \d+: paper-3: robot.urdf: no file 'two_.urdf'"),
        ("robot: two.urdf", "robot: macr", r"1.yaml, line \d+: paper-3: no robot 'macr' \(did you mean macro\?\); ro"),
        ("robot: two.urdf", "robot: macro", r"1.yaml, line \d+: paper-3: joints: 2 names; robot macro has 3 joints"),
        ("model.position", "mine.position", "'mine.position' is Python of .*, which may not run"),
        ("l1: 0.5", "l1: l0", r"1.yaml, line \d+: paper-3: l1, position 1: no name 'l0'"),
        ("J_62: 1", "J_72: 1", r"1.yaml, line \d+: paper-3: no true value of J_72"),
    ],
)  # fmt: skip
def test_what_a_folder_names_and_does_not_exist_is_told(paper, old, new, message):
    with pytest.raises(RunnerError, match=message):
        audit(paper(PAPER.replace(old, new)))


def test_a_robot_is_needed_for_its_truths(paper):
    with pytest.raises(RunnerError, match="names no 'robot'"):
        audit(paper(PAPER.replace("robot: two.urdf\n", "")))
    with pytest.raises(RunnerError, match="a derivation from a model needs a 'robot'; robots: combined, fr3, gen3"):
        audited_arm("", "", (), paper())


def test_python_of_a_folder_runs_where_it_is_allowed(paper):
    folder = paper("symbols: own.draw\nentries: [{id: a, number: '1', place: p, title: t, derivation: own.half,\n"
                   "  printed: {elements: {h: x/2}}}]")  # fmt: skip
    (folder / "equations" / "derivations").mkdir()
    (folder / "equations" / "derivations" / "own.py").write_text(
        "from runner.papers.audit.derivations import Derivations\n"
        "def draw(count, generator): return {'x': generator.uniform(0, 1, count)}\n"
        "half = Derivations(lambda s: {'h': s['x'] / 2}, lambda s: {'h': s['x'] - s['x'] / 2}, ('one', 'two'))\n"
    )
    with pytest.raises(RunnerError, match="which may not run"):
        audit(folder)
    assert [each.verdict for each in audit(Source(folder, code=True))] == ["correct"]
    with pytest.raises(RunnerError, match=r"own.py has no 'halv' \(did you mean half\?\)"):
        derivation_of(Source(folder, code=True), "own.halv")
    with pytest.raises(RunnerError, match="no module; modules: none"):
        consequence_of(Source(folder, code=True), "own.half")


def test_sources_that_are_none_are_told(tmp_path):
    with pytest.raises(RunnerError, match=r"no study 'xarm' \(did you mean xarm7\?\); studies: meca500, thesis, xarm7"):
        audit("xarm")
    with pytest.raises(RunnerError, match="no folder 'equations' in it"):
        list(entries(tmp_path))
