"""Shortcuts in Hydra and OmegaConf: names and values that refer to others are the same as without them."""

import pytest
from hydra._internal import defaults_list
from hydra._internal.config_search_path_impl import ConfigSearchPathImpl
from hydra.core.default_element import GroupDefault
from omegaconf import OmegaConf, base
from omegaconf.errors import GrammarParseError

from runner.config.compose.compose import compose
from runner.config.compose.composer import Composer
from runner.config.compose.shortcuts import KeptRepository, take_shortcuts
from runner.config.compose.sources import CheckedSource, checked_sources


@pytest.fixture(autouse=True)
def _taken():
    take_shortcuts()


def repository(kept):
    with checked_sources([]):
        return KeptRepository(Composer().hydra.config_search_path, kept)


def test_an_interpolation_has_the_value_of_its_own_config():
    for value in (1, 2):
        config = OmegaConf.create({"a": value, "b": "${a}", "c": "x${a}", "d": {"e": "${.f}", "f": value}})
        plain = OmegaConf.to_container(config, resolve=True)
        assert plain == {"a": value, "b": value, "c": f"x{value}", "d": {"e": value, "f": value}}


def test_a_text_is_parsed_once_and_a_faulty_one_refused_each_time():
    assert base.parse("${a}") is base.parse("${a}") is not base.parse("${b}")
    for _ in range(2):
        with pytest.raises(GrammarParseError):
            base.parse("${a")


@pytest.mark.parametrize(("value", "read"), [("one", False), ("${other}", True)])
def test_choices_are_mapped_where_a_name_refers_to_them(value, read):
    overrides = type("Overrides", (), {"known_choices": {"other": "two"}})
    default = GroupDefault(group="group", value=value)
    default.update_parent("", "")
    found = defaults_list._create_interpolation_map(overrides, [default], False)
    assert (found is not None) == read
    if read:
        assert found.other == "two"


def test_what_is_kept_of_a_file_is_given_anew_and_belongs_to_its_folders():
    kept = {}
    one = repository(kept).load_config("plant/rk4")
    assert one.config.kind == "rk4"
    one.config.kind = "changed"
    assert repository(kept).load_config("plant/rk4").config.kind == "rk4"
    assert repository(kept).load_config("plant/no_such_plant") is None
    other = repository(kept)
    other.initialize_sources(ConfigSearchPathImpl())
    assert other.load_config("plant/rk4") is None
    assert repository(kept).load_config("plant/rk4") is not None


def test_a_file_is_read_once_for_several_compositions(monkeypatch, tmp_path):
    read = []
    load = CheckedSource.load_config

    def note(self, config_path):
        read.append(config_path)
        return load(self, config_path)

    monkeypatch.setattr(CheckedSource, "load_config", note)
    (tmp_path / "plant").mkdir()
    (tmp_path / "plant" / "own.yaml").write_text("{kind: rk4, step: 0.001}\n")
    first, second = (compose([f"robot={robot}", "plant=own"], [tmp_path]) for robot in ("macro", "planar"))
    assert [read.count(path) for path in ("plant/own", "robot/macro", "robot/planar")] == [1, 1, 1]
    assert [each.resolved["plant"]["step"] for each in (first, second)] == [0.001, 0.001]
