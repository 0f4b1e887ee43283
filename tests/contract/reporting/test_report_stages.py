"""What commands say of their stages is what they planned."""

import pytest
from support.sample_document import document

from runner.audit.audit import audit_all
from runner.base import progress
from runner.base.progress.stages import AUDITING, FIGURES, HTML, PDF, of_report
from runner.reporting import outline
from runner.reporting.render import write_report


@pytest.fixture
def told(monkeypatch):
    """What is begun, with its total, and the number of steps of each."""
    found = {}

    def begin(name, seconds=None, total=1.0, unit="", count=None):
        found[name] = [total, 0]

    def step(made=1.0):
        found[next(reversed(found))][1] += made

    monkeypatch.setattr(progress, "begin", begin)
    monkeypatch.setattr(progress, "step", step)
    return found


def test_a_report_goes_through_the_stages_that_are_planned_for_it(tmp_path, told):
    write_report(document(), tmp_path)
    assert list(told) == list(of_report(("html", "pdf"))) == [HTML, FIGURES, PDF]
    figures = outline.count_figures(document())
    assert told[FIGURES] == [figures, figures]
    assert figures > 0


@pytest.mark.parametrize(("formats", "stages"), [(("html",), [HTML]), (("pdf",), [FIGURES, PDF])])
def test_a_report_in_one_format_has_its_stages_alone(formats, stages):
    assert list(of_report(formats)) == stages


def test_more_figures_are_expected_to_take_longer():
    assert sum(of_report(("html", "pdf"), 20).values()) > 1.5 * sum(of_report(("html", "pdf"), 10).values())


def test_the_audit_steps_once_for_each_equation(told, monkeypatch):
    monkeypatch.setattr("runner.audit.audit.sources", lambda: ["meca500", "xarm7"])
    judged = audit_all(samples=2)
    count = sum(map(len, judged.values()))
    assert told == {AUDITING: [count, count]}
