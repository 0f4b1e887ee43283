"""Composed options on disk: equal to those that Hydra composes, made anew where they are damaged or files change."""

import json

import pytest
from hydra.types import RunMode
from omegaconf import OmegaConf

from runner.base import cache, paths
from runner.config.compose import composer
from runner.config.compose.composer import Composer, parse
from runner.config.compose.kept_options import _alike, key_of, read_options, write_options
from runner.plugins.discovery import use_plugins

LINES = (
    ("robot=macro",),
    ("robot=xarm7", "controller=three_joint"),
    ("robot=combined", "controller=macro_mini", "noise=thesis"),
    ("experiment=thesis/figure_3_5",),
)


@pytest.fixture(autouse=True)
def _own_cache(code_cache):
    composer._load_options.cache_clear()
    yield
    composer._load_options.cache_clear()


def compose(line, mode=RunMode.RUN, folders=()):
    composer._load_options.cache_clear()
    return Composer(folders)._of_options(parse(line), "config", mode)


def fail(*_):
    raise AssertionError("Hydra composes")


def entries(folder):
    return sorted(folder.glob("answer-options-*"))


@pytest.mark.parametrize("mode", [RunMode.RUN, RunMode.MULTIRUN])
@pytest.mark.parametrize("line", LINES, ids=" ".join)
def test_a_second_process_reads_what_hydra_composed(line, mode, monkeypatch, code_cache):
    first = compose(line, mode)
    assert len(entries(code_cache)) == 1
    monkeypatch.setattr(Composer, "hydra", property(fail))
    second = compose(line, mode)
    assert _alike(first, second)
    assert OmegaConf.to_yaml(first) == OmegaConf.to_yaml(second)


def test_entries_are_plain_data(code_cache):
    compose(LINES[0])
    (path,) = entries(code_cache)
    kept = json.loads(path.read_bytes().split(b"\n", 1)[1])
    assert kept["robot"]["urdf"] == "macro.urdf"


def test_a_damaged_entry_is_made_anew(code_cache):
    first = compose(LINES[0])
    (path,) = entries(code_cache)
    path.write_bytes(path.read_bytes()[:-5])
    assert _alike(first, compose(LINES[0]))
    cache.write_answer(path.name.removeprefix("answer-"), {"hydra": {"run": 3}})
    assert _alike(first, compose(LINES[0]))


def test_a_changed_file_is_composed_again(tmp_path, code_cache):
    file = tmp_path / "mine" / "noise" / "own.yaml"
    file.parent.mkdir(parents=True)
    text = (paths.conf_dir() / "noise" / "thesis.yaml").read_text()
    for position in ("0.25", "0.5"):
        file.write_text(f"{text}\n# {position}\n".replace("position:", f"position: {position} #"))
        assert compose(("robot=macro", "noise=own"), folders=[file.parents[1]]).noise.position == float(position)
    assert len(entries(code_cache)) == 2


def test_nothing_is_kept_with_plug_ins_in_use(tmp_path, monkeypatch, code_cache):
    (tmp_path / "law.py").write_text("def law(t, q, dq, desired, arm):\n    return 0 * q\n")
    monkeypatch.setenv("RUNNER_PLUGINS", "")
    use_plugins([f"controller={tmp_path / 'law.py'}:law"])
    compose(LINES[0])
    assert entries(code_cache) == []


@pytest.mark.parametrize("value", [float("inf"), float("nan"), b"bytes", {1: 2}])
def test_what_plain_data_cannot_hold_is_not_kept(value):
    config = compose(LINES[0])
    OmegaConf.set_struct(config, False)
    config.odd = value
    key = key_of("odd", value)
    write_options(key, config)
    assert read_options(key) is None
