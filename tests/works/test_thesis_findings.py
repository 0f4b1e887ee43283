"""Every condition of the findings on the thesis fails for some value, and the findings bear runs that say nothing."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import pytest
from mutated_runs import mutants, never_failing
from study_sections import every_run
from thin_plans import make_runs, stand_ins
from work_plans import thesis_moments

from runner.reporting.document import Document, Section
from runner.reporting.findings import Finding, findings
from runner.reporting.formulas import faulty
from runner.reporting.measured import Measured
from runner.store import Run
from runner.works.chapters import chapter
from runner.works.thesis import (
    bandwidth,
    base_axis,
    coupling,
    dynamics_cost,
    folding,
    gravity_and_lag,
    lag_by_axis,
    mass_ratio,
    physics,
    reference_velocity,
    report,
    stage_sampling,
    stretch,
    vanishing_mass,
    whole_body,
)
from runner.works.thesis.plan import TRACKED
from runner.works.thesis.studies import mini_dexterity

Build = Callable[[Mapping[str, Run]], Finding]


def of_section(build: Callable[[Mapping[str, Run]], Section], index: int) -> Build:
    """Return the builder of one finding of a section, for those that need what the section works out."""

    def only(runs: Mapping[str, Run]) -> Finding:
        return [found for _, found in findings(Document("", "", "", (build(runs),), "2026-01-01"))][index]

    return only


def folded(runs: Mapping[str, Run]) -> Finding:
    """Return the finding on folding, for which the Mini's dexterity is worked out at the runs that it names alone."""
    names = [f"folding/{case}/tip_goal/quintic" for case in folding._CASES]
    return folding._finding(runs, {name: mini_dexterity(runs[name]) for name in names})


BUILD: dict[str, Build] = {
    "turns": of_section(chapter(report.__file__, "turns"), 0),
    "breaks, payload unknown": partial(mass_ratio._breaking, payload="unknown", carrier=2.0),
    "breaks, payload known": partial(mass_ratio._breaking, payload="known", carrier=2.0),
    "breaks, noise": partial(mass_ratio._noisy, carrier=2.0),
    "coupling, goal": coupling._goal,
    "coupling, trajectory": coupling._quintic,
    "vanishing": of_section(vanishing_mass.vanishing_section, 0),
    "inertial force": of_section(vanishing_mass.vanishing_section, 1),
    "rates": whole_body._rates,
    "speeds": whole_body._speeds,
    "stage sampling": partial(stage_sampling._finding, rates={"macro": 30.0, "mini": 300.0}, kept=()),
    "folding": folded,
    "stretch": partial(stretch._finding, reach=0.2),
    "reference velocity": reference_velocity._finding,
    "lag by axis": lag_by_axis.lag_by_axis,
    "bandwidth": bandwidth._finding,
    "nearer": base_axis._nearer,
    "unlimited": base_axis._unlimited,
    "limited": partial(base_axis._limited, limit=Measured("limit", 50.0, "N m")),
    "no duration": of_section(base_axis.duration_section, 0),
    "gravity": of_section(gravity_and_lag.gravity_section, 0),
    "feedforward": of_section(gravity_and_lag.lag_section, 0),
    "first order": of_section(physics.plants_section, 0),
    "integrator": physics._integrator,
    "stable": physics._stable,
    "similar": of_section(physics.similarity_section, 0),
}


@pytest.fixture(scope="module")
def runs(shared_store: Path, thin: bool) -> dict[str, Run]:
    """Every run of the plan, cut to a moment."""
    return make_runs(shared_store, thesis_moments(), stand_ins(thesis_moments(), thin))


@pytest.mark.parametrize("name", BUILD)
def test_every_condition_fails_for_some_value(runs: dict[str, Run], name: str) -> None:
    assert never_failing(list(mutants(BUILD[name], runs))) == []


def test_the_printed_tracking_errors_are_not_those_at_rest() -> None:
    printed = base_axis.printed_tracking_errors()
    assert [printed[figure] for figure in TRACKED] == [(0.1, 0.15), (0.007, 0.044)]


@pytest.mark.parametrize(("last", "first"), [(3.4e-3, 3.2e-3), (None, None)])
def test_the_closed_form_of_the_period_is_refuted_by_what_grows_and_decays(
    last: float | None, first: float | None
) -> None:
    assert all(condition.holds for condition in stage_sampling._holds(3.3e-3, 3.3e-3, 3.4e-3, "Mini"))
    assert not any(condition.holds for condition in stage_sampling._holds(3.3e-3, last, first, "Mini"))


@pytest.mark.parametrize("time", [1e-4, 1e-3, 1.0])
def test_the_cost_of_the_dynamics_is_refuted_by_a_slow_machine(time: float) -> None:
    good = dynamics_cost._finding(4e-6, 3e-5, 30, 1.2)
    slow = dynamics_cost._finding(10.0 * time, 100.0 * time, 30, 2.5)
    assert good.holds
    assert not any(condition.holds for condition in slow.conditions)


def test_a_finding_on_failed_runs_alone_no_longer_holds(runs: dict[str, Run]) -> None:
    failed = every_run(runs)
    for name in ("turns", "breaks, payload unknown", "breaks, noise", "rates", "speeds", "reference velocity"):
        found = BUILD[name](failed)
        assert not found.holds
        assert faulty(Document("", "", "", (Section("", (found,)),), "2026-01-01")) == []
