"""The example of a paper: its figures and table as two commands write them."""

import shutil

import pytest
import typst

from runner.base.paths import examples_dir

RUN = ("robot=macro", "plant=rk4", "trajectory=quintic", "trajectory.duration=0.6", "noise=thesis", "repetitions=6")


@pytest.mark.costs(4)
def test_a_sweep_becomes_a_paper_by_two_commands(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    swept = cli("-m", *RUN, "controller=computed_torque,operational_space").folder
    assert cli("figures", swept, "--output", "figures").code == 0
    table = ("--by", "controller", "--metrics", "max_tracking_error,peak_torque", "--width", "single", "--output",
             "table.typ")  # fmt: skip
    assert cli("table", swept, *table).code == 0
    shutil.copy(examples_dir() / "paper" / "paper.typ", tmp_path)
    pages = typst.compile(tmp_path / "paper.typ", root=tmp_path, format="svg", ignore_system_fonts=True)
    assert len(pages) == 2
    caption = (tmp_path / "figures" / "difference-in-largest-tracking-error-and-torque.txt").read_text()
    assert ": a dot for each pair, a point for their estimate and a bar for its interval." in caption
    assert "(a) Largest tracking error; (b) Largest torque." in caption
