"""Experiments of a study's folder are found under the folder's name."""

import pytest

from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.compose.composer import Composer
from runner.config.compose.files import group_options

EXPERIMENT = "# @package _global_\n# One.\ndefaults:\n  - override /robot: macro\n  - override /trajectory: goal\n"


@pytest.fixture
def paper(tmp_path):
    folder = tmp_path / "paper"
    (folder / "experiment").mkdir(parents=True)
    (folder / "experiment" / "one.yaml").write_text(EXPERIMENT)
    return folder


def test_an_experiment_of_a_study_is_found_under_the_study_name(paper):
    (paper / "study.yaml").touch()
    assert group_options("experiment", [paper])["paper/one"] == "One."
    assert compose(["experiment=paper/one"], [paper]).choices["experiment"] == "paper/one"
    assert Composer([paper]).load(["experiment=paper/one"]).robot.name == "macro"
    with pytest.raises(ConfigError, match=r"no 'paper/on' \(did you mean paper/one\?\)"):
        compose(["experiment=paper/on"], [paper])


def test_of_another_folder_it_is_found_as_it_stands(paper):
    assert group_options("experiment", [paper])["one"] == "One."
    assert compose(["experiment=one"], [paper]).choices["experiment"] == "one"
    with pytest.raises(ConfigError, match="no 'paper/one'"):
        compose(["experiment=paper/one"], [paper])
