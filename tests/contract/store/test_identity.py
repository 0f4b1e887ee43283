"""Run hash: what counts and what does not, key by key."""

import hashlib
import json
from importlib.metadata import EntryPoint

import pytest
from support.engines import ASKED

from runner.config.compose.compose import compose
from runner.plugins.discovery import source_files
from runner.store import identity, run_hash, run_hashes, simulated_part

CONFIG = {"seed": 0, "controller": {"period": 0.01, "kind": "a"}, "outputs": "x", "preset": {"feedforward": True}}


def changed(**keys):
    return run_hash({**CONFIG, **keys}, "<robot/>")


def test_a_hash_is_a_folder_name():
    name = run_hash(CONFIG, "<robot/>")
    assert len(name) == 24
    assert set(name) <= set("0123456789abcdef")


def test_equal_content_has_an_equal_hash_whatever_the_order():
    turned = json.loads(json.dumps(dict(reversed(CONFIG.items()))))
    assert run_hash(turned, "<robot/>") == run_hash(CONFIG, "<robot/>")


@pytest.mark.parametrize("keys", [{"seed": 1}, {"controller": {"period": 0.02, "kind": "a"}}, {"new": None}])
def test_every_key_counts(keys):
    assert changed(**keys) != changed()


@pytest.mark.parametrize("keys", [{"outputs": "y"}, {"preset": {"feedforward": False}}])
def test_outputs_and_the_preset_do_not_count(keys):
    assert changed(**keys) == changed()


def test_an_experiment_that_says_the_same_does_not_count():
    groups = ("robot=macro", "trajectory=quintic", "noise=thesis", "torque_limits=thesis")
    overrides = (*groups, "repetitions=40", "plant_error=true", "controller.singularity_damping=0.0")
    spelled_out = compose(overrides).resolved
    named = compose(["experiment=thesis/figure_3_9"]).resolved
    assert run_hash(named, "") == run_hash(spelled_out, "")


def test_what_is_hashed_is_json_with_sorted_keys(monkeypatch):
    texts, make = [], hashlib.sha256
    monkeypatch.setattr(identity.hashlib, "sha256", lambda text=b"": texts.append(text) or make(text))
    config = compose(["robot=macro", ASKED, "noise=thesis", "torque_limits.max=[1,2,3]"]).resolved
    urdf = '<robot name="é">\n</robot>'
    name = run_hash(config, urdf)
    content = json.loads(texts[-1])
    assert texts[-1].decode() == json.dumps(content, sort_keys=True)
    assert name == make(texts[-1]).hexdigest()[:24]
    assert set(content) == {"config", "engines", "parts", "source", "urdf"}
    assert (content["config"], content["urdf"]) == (simulated_part(config), urdf)
    assert content["source"] == identity.physics_digest()
    assert "pin" in content["engines"]


def test_hashes_of_many_seeds_are_those_of_each_alone():
    config = compose(["robot=macro", ASKED, "noise=thesis", "torque_limits.max=[1,2,3]"]).resolved
    urdf = '<robot name="é">\n</robot>'
    seeds = [config["seed"], 17, 123456]
    assert list(run_hashes(config, urdf, seeds)) == [run_hash({**config, "seed": seed}, urdf) for seed in seeds]


def test_the_robot_counts():
    assert run_hash(CONFIG, "<robot/>") != run_hash(CONFIG, "<robot />")


def test_the_engines_versions_count(monkeypatch):
    """Versions are kept by the kind of plant: each kind here is asked for once."""
    before = changed(plant={"kind": "of a stranger"})
    monkeypatch.setattr(identity, "simulated_part", lambda _: {"seed": 0})
    alone, other = (run_hash({"plant": {"kind": kind}}, "<robot/>") for kind in ("of a stranger", "of another"))
    assert alone == other != before
    monkeypatch.setattr(identity, "engine_versions", lambda plant: {"pin": "9.9"})
    assert run_hash({"plant": {"kind": "of a third"}}, "<robot/>") != alone


def test_the_physics_counts(monkeypatch):
    before = changed()
    monkeypatch.setattr(identity, "physics_digest", lambda: "other")
    assert changed() != before


def test_the_simulated_part_leaves_out_what_does_not_count():
    assert set(simulated_part(CONFIG)) == {"seed", "controller"}


def test_a_part_counts_in_the_runs_that_use_it(monkeypatch):
    point = EntryPoint("a", "runner.papers.studies.xarm7.parts.three_joint", "runner.controller")
    other = {"controller": {"kind": "b"}}
    before = changed(), changed(**other)
    monkeypatch.setattr(identity, "added_parts", lambda group: (point,) if group == "controller" else ())
    assert changed() != before[0]
    assert changed(**other) == before[1]


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("A part.", "Another text.", True),
        ("2.0", "2.0  # text", True),
        ("2.0", "2.5", False),
        ("def build", "def make", False),
    ],
)
def test_of_a_part_the_content_counts(monkeypatch, tmp_path, old, new, same):
    text = '"""A part."""\nGAIN = 2.0\ndef build(): return GAIN\n'
    monkeypatch.setattr(
        identity, "added_parts", lambda group: (EntryPoint("a", "part", group),) if group == "plant" else ()
    )
    names = []
    for place, source in enumerate((text, text.replace(old, new))):
        path = tmp_path / str(place) / "part.py"
        path.parent.mkdir()
        path.write_text(source)
        monkeypatch.setattr(identity, "source_files", lambda _, path=path: [path])
        identity._parts_digest.cache_clear()
        names.append(changed())
    identity._parts_digest.cache_clear()
    assert (names[0] == names[1]) == same


def test_of_a_part_of_our_studies_the_source_is_its_folder():
    names = [path.name for path in source_files("runner.papers.studies.xarm7.parts.three_joint")]
    assert names == ["__init__.py", "three_joint.py", "three_joint_kinematics.py", "xarm7_as_printed.py"]
