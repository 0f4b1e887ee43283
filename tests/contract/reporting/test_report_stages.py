"""Stages that commands begin, with their steps."""

import pytest
from support.sample_document import document

from runner.base import progress
from runner.papers.audit.audit import audit_all
from runner.reporting import outline
from runner.reporting.render import write_report

STAGES = {"html": ["writing the HTML"], "pdf": ["drawing figures", "writing the PDF"]}


@pytest.fixture
def told(monkeypatch):
    """The stages that begin, each with its total and its number of steps."""
    found = {}

    def begin(name, total=None, unit="", count=None):
        found[name] = [total, 0]

    def step(made=1.0):
        found[next(reversed(found))][1] += made

    monkeypatch.setattr(progress, "begin", begin)
    monkeypatch.setattr(progress, "step", step)
    return found


def test_a_report_goes_through_its_stages(tmp_path, told):
    write_report(document(), tmp_path)
    assert list(told) == [*STAGES["html"], *STAGES["pdf"]]
    figures = outline.count_figures(document())
    assert told["drawing figures"] == [figures, figures]
    assert figures > 0


@pytest.mark.parametrize("formats", STAGES)
def test_a_report_in_one_format_has_its_stages_only(tmp_path, told, formats):
    write_report(document(), tmp_path, (formats,))
    assert list(told) == STAGES[formats]


def test_the_audit_steps_once_for_each_equation(told, monkeypatch):
    monkeypatch.setattr("runner.papers.audit.audit.sources", lambda: ["meca500", "xarm7"])
    checked = audit_all(samples=2)
    count = sum(map(len, checked.values()))
    assert told == {"auditing": [count, count]}
