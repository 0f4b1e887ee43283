"""Comparison of engines on a text: what they read differently is named by joint or link and by limit."""

import numpy as np
import pytest
from support.unusual_arms import LIMIT, arm, first, second

from runner.assembly import engine_check
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.plants.agreement import ENGINES, Agreement, compare
from runner.robots.description import read_urdf
from runner.robots.model import RobotModel

KINDS = [pytest.param(kind, marks=[pytest.mark.bullet] * (kind == "bullet")) for kind in ENGINES]


@pytest.fixture
def canonical(tmp_path):
    def make(text):
        (tmp_path / "arm.urdf").write_text(text)
        return read_urdf(tmp_path / "arm.urdf", {})

    return make


def compared(kind, urdf, model):
    return compare(kind, urdf, model, 3, np.random.default_rng(0))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "text", [arm(), first(limit=LIMIT.replace('lower="-2" ', "")), second(axis='<axis xyz="1 1 0"/>')]
)
def test_engines_agree_on_canonical_texts(kind, text, canonical):
    urdf = canonical(text)
    off, difference = compared(kind, urdf, RobotModel(urdf, "tool0"))
    assert difference == ""
    assert off < 1e-9


@pytest.mark.bullet
@pytest.mark.parametrize(
    ("new", "said"),
    [
        ('<axis xyz="0.0 0.0 2.0"/>', "has the axis 0 0 2 at 0 0 0.3 m in PyBullet and the axis 0 0 1 at 0 0 0.3 m in"),
        ('<axis xyz="0.0 1.0 0.0"/>', "has the axis 0 1 0 at 0 0 0.3 m in PyBullet and the axis 0 0 1 at"),
    ],
)
def test_the_joint_that_bullet_reads_otherwise_is_named(new, said, canonical):
    urdf = canonical(arm())
    old = '<axis xyz="0.0 0.0 1.0" />'
    assert old in urdf
    difference = compared("bullet", urdf.replace(old, new, 1), RobotModel(urdf, "tool0")).difference
    assert difference.startswith(f"joint 'j1' {said}")


@pytest.mark.parametrize("kind", KINDS)
def test_a_moved_joint_and_a_heavy_link_are_named(kind, canonical):
    urdf = canonical(arm())
    model, engine = RobotModel(urdf, "tool0"), ENGINES[kind]
    parts = urdf.split("<joint", 3)
    moved = "<joint".join([*parts[:2], parts[2].replace("0.0 0.0 0.3", "0.0 0.1 0.3"), parts[3]])
    assert f"joint 'j2' has the axis 0 1 0 at 0 0.1 0.6 m in {engine} and the axis 0 1 0 at 0 0 0.6 m" in (
        compared(kind, moved, model).difference
    )
    heavy = urdf.replace('<mass value="1.0" />', '<mass value="1.5" />')
    said = compared(kind, heavy, model).difference
    assert said.startswith("link 'l3' and what it carries have")
    assert f"kg m^2 for their joint in {engine} and" in said


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("new", "said"),
    [
        ('lower="-1.5"', "does not stop at its limit of -1.5 rad"),
        ('lower="-2.5"', "stops before its limit of -2.5 rad"),
    ],
)
def test_a_limit_that_an_engine_reads_otherwise_is_named(kind, new, said, canonical):
    urdf = canonical(arm())
    assert 'lower="-2.0"' in urdf
    theirs, ours = (urdf, urdf.replace('lower="-2.0"', new, 1))
    difference = compared(kind, theirs, RobotModel(ours, "tool0")).difference
    assert difference == f"joint 'j1' {said} in {ENGINES[kind]}"


HAND = """# @package _global_
# A small arm
defaults:
  - override /controller: computed_torque
  - override /trajectory: quintic
robot:
  name: small
  urdf: small.urdf
  tip: tool0
  home: [0.1, 0.4, 0.9]
  goal: [0.35, 0.2, 0.6]
"""


@pytest.fixture
def by_hand(tmp_path, monkeypatch):
    """Validate a config of a user's file; an empty cache folder is used."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    engine_check._difference.cache_clear()

    def make(plant, text):
        for folder, name, content in (("robot", "small.yaml", HAND), ("robots", "small.urdf", text)):
            (tmp_path / folder).mkdir(exist_ok=True)
            (tmp_path / folder / name).write_text(content)
        return validate(compose(["robot=small", f"plant={plant}"], [tmp_path]))

    return make


def test_a_user_s_file_is_compared_once(by_hand, monkeypatch):
    called = []

    def counted(kind, *rest):
        called.append(kind)
        return compare(kind, *rest)

    monkeypatch.setattr(engine_check, "compare", counted)
    by_hand("rk4", arm())
    assert called == []
    for _ in range(2):
        by_hand("mujoco", arm())
        engine_check._difference.cache_clear()  # as another process
    assert called == ["mujoco"]
    by_hand("mujoco", first(axis='<axis xyz="0 0 2"/>'))  # the same canonical text
    assert called == ["mujoco"]
    by_hand("mujoco", second(axis='<axis xyz="1 1 0"/>'))
    assert called == ["mujoco", "mujoco"]


def test_an_engine_that_differs_is_refused(by_hand, monkeypatch):
    monkeypatch.setattr(engine_check, "compare", lambda *_: Agreement(1.0, "joint 'j2' has another axis"))
    with pytest.raises(ConfigError, match=r"MuJoCo and Pinocchio simulate .*small.urdf differently: joint 'j2' has an"):
        by_hand("mujoco", arm())


def test_built_in_arms_are_left_to_their_test(monkeypatch):
    monkeypatch.setattr(engine_check, "compare", lambda *_: 1 / 0)
    validate(compose(["robot=planar", "plant=mujoco"]))
