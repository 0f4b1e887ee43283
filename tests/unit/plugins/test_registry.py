"""Registry of kinds: look-up, late import, copies for plug-ins and strict models."""

import sys
import types
from importlib.metadata import EntryPoint

import numpy as np
import pytest
from pydantic import ValidationError

from runner.base.errors import ConfigError
from runner.plugins import registry
from runner.plugins.registry import Registry
from runner.schema.model import StrictModel


class Config(StrictModel):
    kind: str
    size: float


@pytest.fixture
def parts(monkeypatch):
    """A registry with one built-in kind and one of another package."""
    for name in ("own", "foreign"):
        module = types.ModuleType(f"some_{name}")
        module.__name__ = "runner.some_own" if name == "own" else "some_foreign"
        module.CONFIG, module.build = Config, lambda config, *args, name=name: (name, config.size, *args)
        monkeypatch.setitem(sys.modules, f"some_{name}", module)
    points = [EntryPoint("foreign", "some_foreign", "runner.part")]
    monkeypatch.setattr(registry, "added_parts", lambda group: points if group == "part" else [])
    return Registry("part", {"own": "some_own"})


def test_kinds_of_other_packages_stand_among_ours(parts):
    assert parts.names() == ["foreign", "own"]
    assert parts.config_model("foreign") is Config


@pytest.mark.parametrize("kind", ["own", "foreign"])
def test_the_kind_decides_what_is_built(parts, kind):
    assert parts.build(Config(kind=kind, size=2.0), "arm") == (kind, 2.0, "arm")


def test_an_unknown_kind_names_the_nearest(parts):
    with pytest.raises(ConfigError) as raised:
        parts.config_model("owm")
    assert raised.value.problems == ("part.kind: 'owm' is unknown (did you mean own?); known: foreign, own",)


def test_a_module_is_imported_when_its_kind_is_used():
    assert Registry("part", {"gone": "no.such.module"}).names() == ["gone"]
    with pytest.raises(ConfigError, match=r"part gone: module no.such.module cannot be imported: ModuleNotFoundError"):
        Registry("part", {"gone": "no.such.module"}).config_model("gone")


def test_a_module_without_a_config_model_is_refused(parts):
    sys.modules["some_foreign"].CONFIG = dict
    with pytest.raises(ConfigError, match=r"module some_foreign of 'foreign' needs CONFIG, a class derived from"):
        parts.config_model("foreign")


def test_a_kind_of_the_users_gets_copies_and_is_guarded(parts):
    parts = Registry("part", {"own": "some_own"}, guard=lambda built, config, *args: ("guarded", built, *args))
    arm = np.zeros(3)

    def build(config, arm):
        arm[:] = 1.0
        return "part"

    sys.modules["some_foreign"].build = build
    assert parts.build(Config(kind="foreign", size=2.0), arm) == ("guarded", "part", arm)
    assert not arm.any()
    assert parts.build(Config(kind="own", size=2.0), arm)[2] is arm


def test_what_a_kind_of_the_users_raises_is_told_with_its_place(parts):
    def build(config, *args):
        raise KeyError("spring")

    sys.modules["some_foreign"].build = build
    with pytest.raises(
        ConfigError, match=r"part.kind: 'foreign' cannot be built: KeyError: 'spring' \(test_registry.py, line \d+, in"
    ):
        parts.build(Config(kind="foreign", size=2.0))


class Positions:
    def joint_positions(self, time, q, dq, reference):
        return q


class Torques:
    def torque(self, time, q, dq, reference):
        return q


@pytest.mark.parametrize(
    ("commands", "law", "wrong", "right"),
    [
        ("torque", Positions, "joint_positions instead of torque", "position"),
        ("position", Torques, "torque instead of joint_positions", "torque"),
    ],
)
def test_a_law_of_the_other_command_names_the_member_to_write(parts, commands, law, wrong, right):
    parts = Registry("part", {"own": "some_own"}, guard=lambda built, config: built)
    module = sys.modules["some_foreign"]
    module.COMMANDS, module.build = commands, lambda config: (types.SimpleNamespace(controller=law()),)
    why = f'\'foreign\' has COMMANDS = "{commands}", and its law {law.__name__} has {wrong}; write COMMANDS = "{right}"'
    with pytest.raises(ConfigError, match=why):
        parts.build(Config(kind="foreign", size=2.0))
    module.COMMANDS = right
    assert isinstance(parts.build(Config(kind="foreign", size=2.0))[0].controller, law)


@pytest.mark.parametrize("size", ["1", True, None, float("nan"), float("inf"), [1.0]])
def test_models_convert_nothing(size):
    with pytest.raises(ValidationError):
        Config(kind="own", size=size)


def test_models_take_whole_numbers_for_real_ones():
    assert Config(kind="own", size=1).size == 1.0


def test_models_refuse_unknown_keys_and_changes():
    with pytest.raises(ValidationError, match="Extra inputs"):
        Config(kind="own", size=1.0, colour="red")
    with pytest.raises(ValidationError, match="frozen"):
        Config(kind="own", size=1.0).size = 2.0


def test_every_kind_of_ours_can_be_imported():
    from runner.controllers import CONTROLLERS
    from runner.plants import PLANTS
    from runner.trajectories import TRAJECTORIES

    for group in (CONTROLLERS, PLANTS, TRAJECTORIES):
        for kind in group.names():
            assert "kind" in group.config_model(kind).model_fields
