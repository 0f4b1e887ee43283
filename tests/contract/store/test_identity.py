"""Run hash: what counts and what does not, key by key."""

import hashlib
import json
from importlib.metadata import EntryPoint

import pytest
from support.engines import ASKED

from runner.config.compose import compose
from runner.paths import package_dir
from runner.plugins import source_files
from runner.store import identity, run_hash, run_hashes, simulated_part

CONFIG = {"seed": 0, "controller": {"period": 0.01, "kind": "a"}, "outputs": "x", "preset": {"feedforward": True}}


@pytest.fixture(autouse=True)
def _fresh_digest():
    identity.source_digest.cache_clear()
    yield
    identity.source_digest.cache_clear()


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
    assert content["source"] == identity.source_digest()
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
    monkeypatch.setattr(identity, "installed", lambda names: dict.fromkeys(names, "9.9"))
    assert run_hash({"plant": {"kind": "of a third"}}, "<robot/>") != alone


def test_the_source_counts_but_not_that_of_reports_and_commands(monkeypatch, tmp_path):
    others = ("reporting/page.py", "commands/run.py", "cli.py", "a_new_room/part.py")
    for name in ("simulation.py", "controllers/law.py", *others):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("1")
    monkeypatch.setattr(identity, "package_dir", lambda: tmp_path)

    def digest():
        identity.source_digest.cache_clear()
        return identity.source_digest()

    before = digest()
    for name in others:
        (tmp_path / name).write_text("2")
    assert digest() == before
    (tmp_path / "controllers/law.py").write_text("2")
    assert digest() != before
    before = digest()
    (tmp_path / "controllers/law.py").rename(tmp_path / "controllers/rule.py")
    assert digest() != before


def test_every_room_is_physics_or_known_not_to_be(monkeypatch, tmp_path):
    """A new room belongs to one of the two lists; what decides about results must count in the hash."""
    after_the_run = {
        "api", "audit", "caveats", "claims", "cli.py", "commands", "comparison", "data_file.py", "doctor",
        "engine_output.py", "engines.py", "errors.py", "export", "folder_code.py",
        "completion", "drawing", "expressions", "latest.py", "paths.py", "plugins.py", "progress", "provenance.py",
        "quantities.py", "quiet.py", "recall", "recordings", "references", "reporting", "sensitivity",
        "servo_contact.py", "spec", "statistics", "store", "sweeps", "texts.py", "tuning",
        "works",
        "__init__.py", "__main__.py",
    }  # fmt: skip
    rooms = {path.name for path in package_dir().iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
    assert rooms_that_count(monkeypatch, tmp_path, rooms) == rooms - after_the_run
    assert after_the_run <= rooms


def rooms_that_count(monkeypatch, package, rooms):
    """Return the rooms whose source changes the digest."""
    files = {room: package / room if room.endswith(".py") else package / room / "part.py" for room in rooms}
    for file in files.values():
        file.parent.mkdir(exist_ok=True)
        file.write_text("1")
    monkeypatch.setattr(identity, "package_dir", lambda: package)
    digests = {}
    for room, file in [("", None), *files.items()]:
        if file:
            file.write_text("2")
        identity.source_digest.cache_clear()
        digests[room] = identity.source_digest()
        if file:
            file.write_text("1")
    return {room for room, digest in digests.items() if digest != digests[""]}


def test_the_simulated_part_leaves_out_what_does_not_count():
    assert set(simulated_part(CONFIG)) == {"seed", "controller"}


def test_a_part_counts_in_the_runs_that_use_it(monkeypatch):
    point = EntryPoint("a", "runner.works.xarm7.parts.three_joint", "runner.controller")
    other = {"controller": {"kind": "b"}}
    before = changed(), changed(**other)
    monkeypatch.setattr(identity, "added", lambda group: (point,) if group == "controller" else ())
    assert changed() != before[0]
    assert changed(**other) == before[1]


def test_of_a_part_of_our_works_the_source_is_its_folder():
    names = [path.name for path in source_files("runner.works.xarm7.parts.three_joint")]
    assert names == ["__init__.py", "three_joint.py", "three_joint_kinematics.py", "xarm7_as_printed.py"]
