"""What the thesis' chapters conclude is refuted by runs and measurements that say otherwise."""

from collections.abc import Callable

import pytest
from fixtures.studies import Made, made_up_costs
from support.study_sections import every_run

from runner.reporting.document import Document, Section
from runner.reporting.formulas import faulty
from runner.studies.thesis import dynamics_cost, figures, stage_sampling
from runner.study.measured import Measured, findings


@pytest.mark.parametrize(("claim", "ends"), [(3, (0.1, 0.15)), (4, (0.007, 0.044))])
def test_the_printed_tracking_errors_are_not_those_at_rest(claim: int, ends: tuple[float, float]) -> None:
    assert tuple(figures.printed(claim, end, "").value for end in (0, -1)) == ends


@pytest.mark.parametrize(("last", "first"), [(3.4, 3.2), (None, None)])
def test_the_closed_form_of_the_period_is_refuted_by_what_grows_and_decays(
    last: float | None, first: float | None
) -> None:
    closed, decays, grows = (Measured(name, value, "ms") for name, value in zip("cdg", (3.3, 3.3, 3.4), strict=True))
    assert all(condition.holds for condition in stage_sampling.bracketed([(closed, decays, grows)]))
    decays, grows = Measured("d", last, "ms"), Measured("g", first, "ms")
    assert not any(condition.holds for condition in stage_sampling.bracketed([(closed, decays, grows)]))


@pytest.mark.parametrize(("slower", "power", "holds"), [(1.0, 1.2, True), (300.0, 2.5, False)])
def test_the_cost_of_the_dynamics_is_refuted_by_a_slow_machine(
    made: Callable[[str], Made], monkeypatch: pytest.MonkeyPatch, slower: float, power: float, holds: bool
) -> None:
    monkeypatch.setattr(dynamics_cost, "load", lambda path: made_up_costs(slower * 1e-7, power))
    thesis = made("thesis")
    section = thesis.spoiled(dict).section("dynamics_cost.md")
    (found,) = (found for _, found in findings(_document(section)))
    assert [condition.holds for condition in found.conditions] == [holds] * 3
    cost = dynamics_cost.measured_cost(thesis.runs, 12)
    assert cost["power"].value == pytest.approx(power)
    assert cost["six"].value == pytest.approx(slower * 0.3 * 6.0**power)


@pytest.mark.parametrize("name", ["turns", "mass_ratio", "whole_body", "reference_velocity", "folding"])
def test_a_finding_on_failed_runs_alone_no_longer_holds(made: Callable[[str], Made], name: str) -> None:
    document = _document(made("thesis").spoiled(every_run).section(f"{name}.md"))
    assert [found.claim for _, found in findings(document) if found.holds] == []
    assert faulty(document) == []


def _document(section: Section) -> Document:
    return Document("", "", "", (section,), "2026-01-01")
