"""Studies on the thesis: failed runs, and the checklist."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from fixtures.studies import Made
from support.study_sections import every_run, texts

from runner.papers.studies.thesis_beyond import force
from runner.papers.study.report import load_checklist
from runner.reporting.document import Origin, Section, Table
from runner.reporting.figures import torque_and_error
from runner.store import Run

STUDIES = ("coupling", "mass_ratio", "folding", "stretch", "reference_velocity", "turns", "whole_body")


@pytest.fixture
def runs(made: Callable[[str], Made]) -> Mapping[str, Run]:
    return made("thesis").runs


def test_a_failed_run_is_shown_with_its_failure(made: Callable[[str], Made]) -> None:
    chapters = made("thesis").spoiled(every_run)
    told = {name: any("for this test" in text for text in texts(chapters.section(f"{name}.md"))) for name in STUDIES}
    assert told == dict.fromkeys(STUDIES, True)


def test_the_checklist_finds_its_places_and_names_what_is_missing(runs: Mapping[str, Run]) -> None:
    figure = replace(torque_and_error(runs["figure_5_8/full_equations"], "A figure."), origin=Origin("figure 5.8"))
    checklist = load_checklist("thesis")
    assert checklist is not None
    section = checklist.section([Section("Elsewhere"), Section("Here", sections=(Section("Below", (figure,)),))])
    rows = {row[0]: row for block in section.blocks if isinstance(block, Table) for row in block.lines[1:]}
    assert len(rows) == 42
    assert rows["Figure 5.8"][2:] == ["reproduced", "§2.1"]
    assert rows["Figure 5.9"][2] == "missing"
    assert rows["Figure 1.1"][2].startswith("of others")


def test_the_closed_rise_time_is_that_of_a_critically_damped_step(made: Callable[[str], Made]) -> None:
    """omega_c^2 = k (1 + k_f) / m, and x'' = omega_c^2 (1 - x) - 2 omega_c x'."""
    for name in ("force/step/macro/1000", "force/stiff/mini/40000"):
        run = made("thesis_beyond").runs[name]
        stiffness, gain = run.config["environment"]["stiffness"], run.config["controller"]["force_gain"]
        rate = np.sqrt(stiffness * (1.0 + gain) / force.mass_at_start(run))
        t, x = scipy.signal.step(([rate**2], [1.0, 2.0 * rate, rate**2]), T=np.linspace(0.0, 8.0 / rate, 8001))
        assert force.closed_rise_time(run) == pytest.approx(np.interp(0.9, x, t) - np.interp(0.1, x, t), rel=1e-4)
