"""Configs that are read without Hydra equal those that Hydra composes."""

import random
import subprocess
import sys

import pytest

from runner.base.dotted_keys import leaves, with_references
from runner.base.errors import ConfigError
from runner.config.compose import composer, unresolved
from runner.config.compose.compose import compose
from runner.config.compose.unresolved import plain_value, read_unresolved

OPTIONS = (
    ("robot=macro",),
    ("robot=combined", "controller=macro_mini", "noise=thesis", "trajectory=quintic"),
    ("robot=xarm7", "controller=three_joint"),
    ("robot=panda", "plant=mujoco", "noise=thesis"),
    ("experiment=thesis/figure_3_5",),
)
VALUES = ("1", "-3", "0", "0.5", "-2.5e-3", "1e6", "20ms", "3deg", "0.1m", "word", "a_b2", "true", "false", "null")
MORE = ("/tmp/a/b.c", "./x", "'quoted words'", "a/b", "''")
LISTS = ("[1,2]", "[0.5, -1, 1e-3]", "[1mm,20ms]", "[word,null,true]", "[3]", "[a/b, 1]")


@pytest.fixture(autouse=True)
def _own_cache(code_cache):
    caches = unresolved._kept, composer._load_options
    for each in caches:
        each.cache_clear()
    yield
    for each in caches:
        each.cache_clear()


def by_hydra(line, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(unresolved, "read_kept", lambda *_: None)
        return read_unresolved(line, (), "config")


@pytest.mark.parametrize("options", OPTIONS, ids=" ".join)
def test_what_is_read_is_what_hydra_composes(options, monkeypatch):
    first = by_hydra(options, monkeypatch)
    rng = random.Random(7)
    keys = [".".join(place) for place, _ in leaves(first.values, lists=False) if all(isinstance(k, str) for k in place)]
    lines = [(*options, f"{key}={rng.choice(VALUES + MORE + LISTS)}") for key in rng.sample(keys, 25)]
    lines += [(*options, "controler.period=5ms"), (*options, "controller.periode=5ms"), (*options, "durations=3")]
    read = 0
    for line in (options, *lines):
        found = unresolved.read_kept(line, (), "config")
        if found is not None:
            read += 1
            wanted = by_hydra(line, monkeypatch)
            assert found == wanted
            assert [*leaves(found.values)] == [*leaves(wanted.values)]  # in the same order
    assert read > 15


@pytest.mark.parametrize("text", [*VALUES, *MORE, *LISTS])
def test_a_plain_value_is_that_of_the_grammar(text):
    from runner.config.compose.composer import parse

    wanted, found = parse([f"key={text}"])[0].value(), plain_value(text)
    pairs = zip(wanted, found, strict=True) if isinstance(wanted, list) else [(wanted, found)]
    for its, ours in pairs:
        assert type(ours) is type(getattr(its, "text", its))
        assert ours == getattr(its, "text", its)


@pytest.mark.parametrize(
    "text",
    [
        "1,2",
        "[]",
        "[[1],2]",
        "[1,,2]",
        "[1,range(1,3)]",
        "[${a},1]",
        "['a,b']",
        "{a: 1}",
        "range(1,3)",
        "${robot.period}",
        "007",
        "1_000",
        "NaN",
        "inf",
        "a b",
        "a\\,b",
    ],
)
def test_any_other_value_is_left_to_hydra(text):
    with pytest.raises(ValueError):  # noqa: PT011 - it names the value or a part of it
        plain_value(text)


@pytest.mark.parametrize(
    "line",
    [
        ("robot=macro", "hydra.sweeper.workers=2"),
        ("robot=macro", "+experiment=thesis/figure_3_5"),
        ("robot=macro", "~noise"),
        ("robot=macro", "robot.goal=3"),
        ("robot=macro", "trajectory.goal.0=3"),
        ("robot=macro", "robot.masses=none"),
        ("robot=nowhere",),
    ],
    ids=" ".join,
)
def test_what_needs_hydra_is_left_to_it(line, monkeypatch):
    by_hydra(("robot=macro",), monkeypatch)
    assert unresolved.read_kept(line, (), "config") is None


def test_a_changed_file_is_composed_again(tmp_path, monkeypatch):
    home = tmp_path / "home"
    folder = home / "noise"
    folder.mkdir(parents=True)
    (folder / "mine.yaml").write_text("defaults: [none]\nposition: 1e-3\n")
    line = ("robot=macro", "noise=mine")
    assert read_unresolved(line, (home,), "config").values["noise"]["position"] == 1e-3
    assert unresolved.read_kept(line, (home,), "config") is not None
    (folder / "mine.yaml").write_text("defaults: [none]\nposition: 2e-3  # other\n")
    assert unresolved.read_kept(line, (home,), "config") is None
    assert read_unresolved(line, (home,), "config").values["noise"]["position"] == 2e-3


def test_a_damaged_entry_is_left_to_hydra(monkeypatch):
    line = ("robot=macro",)
    wanted = by_hydra(line, monkeypatch)
    for damaged in ({}, {"hydra": 1}, {"hydra": {"runtime": {"choices": {}}}}):
        monkeypatch.setattr(unresolved, "read_content", lambda _, content=damaged: content)
        assert read_unresolved(line, (), "config") == wanted


@pytest.mark.costs(4)
def test_a_second_process_with_the_same_options_does_not_import_hydra():
    script = (
        "import sys; from runner.config.compose.compose import compose; compose(sys.argv[1:]); "
        "print({'hydra', 'omegaconf', 'antlr4'} & set(sys.modules))"
    )
    words = [sys.executable, "-c", script, "robot=macro", "trajectory=quintic"]
    ends = [subprocess.run([*words, f"seed={k}"], capture_output=True, text=True, check=True).stdout for k in (1, 2)]
    assert "hydra" in ends[0]
    assert ends[1] == "set()\n"


REFERENCES = {"a": {"b": 1.5, "c": [1, {"d": "${a.b}"}]}, "e": "${a}", "f": "${a.c}", "g": {"h": "${e}"}}


def test_references_are_those_of_omegaconf():
    from omegaconf import OmegaConf

    assert with_references(REFERENCES) == OmegaConf.to_container(OmegaConf.create(REFERENCES), resolve=True)
    found = with_references(REFERENCES)
    assert found["e"] is not found["a"]


@pytest.mark.parametrize("value", ["x ${a.b}", "${.b}", "${e.b}", "${a.c[0]}", "${none}", "${f.0}", "${loop}", "${m}"])
def test_other_references_are_left_to_omegaconf(value):
    assert with_references(REFERENCES | {"loop": "${loop}", "m": "???", "value": value}) is None


def test_an_unknown_reference_is_explained(tmp_path):
    (tmp_path / "noise").mkdir()
    (tmp_path / "noise" / "mine.yaml").write_text("defaults: [none]\nposition: ${robot.accuracy}\n")
    with pytest.raises(ConfigError, match=r"noise.position: it refers to robot.accuracy, which the chosen robot lacks"):
        compose(("robot=macro", "noise=mine"), (tmp_path,))
