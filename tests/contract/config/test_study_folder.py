"""Experiments of a study's folder are found under the folder's name."""

import pytest

from runner.base.errors import ConfigError
from runner.base.paths import studies_dir
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


@pytest.mark.parametrize("name", ["benchmark/macro", "thesis/figure_3_5"])
def test_experiments_of_built_in_studies_need_no_folder(name):
    study = studies_dir() / name.partition("/")[0]
    assert group_options("experiment")[name]
    assert not {"macro", "figure_3_5"} & {*group_options("experiment")}
    found = [compose([f"experiment={name}"], folders) for folders in ([], [study])]
    assert found[0].choices["experiment"] == name
    assert found[0].resolved == found[1].resolved
    for refused in ("engines/macro", f"{name}/x", "benchmark", "benchmark/../thesis/figure_3_5"):
        with pytest.raises(ConfigError, match="experiment"):
            compose([f"experiment={refused}"])
    with pytest.raises(ConfigError, match="robot: no 'kuka'"):
        compose(["robot=kuka"])


def test_of_another_folder_it_is_found_as_it_stands(paper):
    assert group_options("experiment", [paper])["one"] == "One."
    assert compose(["experiment=one"], [paper]).choices["experiment"] == "one"
    with pytest.raises(ConfigError, match="no 'paper/one'"):
        compose(["experiment=paper/one"], [paper])
