"""Sections of reports by plug-ins that go wrong: the report is whole, and states which section failed."""

import re
from dataclasses import replace

import pytest

from runner.plugins.discovery import has_users_parts
from runner.reporting.document import Notice
from runner.reporting.render import write_report
from runner.reporting.run_report import run_document
from runner.reporting.sections import RunSubject, added_sections
from runner.reporting.sweep.report import sweep_document
from runner.store import open_run, run_hash

FAULTS = {
    "def run_section(subject):\n    return subject.run.metrics['none']\n": (
        r"section own: .*UnknownMetricError: unknown metric 'none'.* \(own.py, line 2, in run_section\)\."
    ),
    "def run_section(subject):\n    return 3\n": (
        r"run_section \(own.py, line 1\) gave 3; it must be a Section or None\."
    ),
    "from runner.plugin import Section\n\ndef run_section(subject):\n    return Section('Own', ('a text',))\n": (
        r"run_section \(own.py, line 3\) gave a section that cannot be shown: AttributeError: 'str' object .*\."
    ),
    "from runner.plugin import Section, Table\n\ndef run_section(subject):\n"
    "    return Section('Own', (Table('One.', ['a', 'b'], 5),))\n": (
        r"run_section \(own.py, line 3\) gave a section that cannot be shown: TypeError: .*\."
    ),
    "def run_section(subject:\n": r"section own: module own cannot be imported: SyntaxError: .* \(own.py, line 1\)\.",
    "import nowhere\n": (
        r"section own: module own cannot be imported: ModuleNotFoundError: .* \(own.py, line 1, in <module>\)\."
    ),
    "section = None\n": r"section own: module own needs one of run_section, .*, identification_section\.",
}


@pytest.fixture
def finished(runs):
    return runs["quintic"]


@pytest.mark.parametrize("module", FAULTS)
def test_a_section_that_fails_is_named(own_part, finished, module):
    own_part("section", "own", module)
    (section,) = added_sections("run", RunSubject(finished))
    (notice,) = section.blocks
    assert isinstance(notice, Notice)
    assert (notice.kind, notice.title) == ("failure", "The section of plug-in own failed")
    assert re.fullmatch(FAULTS[module], notice.text), notice.text


def test_a_report_with_a_failed_section_is_whole(own_part, finished, tmp_path):
    own_part("section", "own", "def run_section(subject):\n    return 1 / 0\n")
    document = run_document(finished)
    assert [section.title for section in document.sections] == ["The run", "Section own", "Config", "Provenance"]
    page, paper = write_report(document, tmp_path / "report")
    assert "ZeroDivisionError: division by zero (own.py, line 2, in run_section)" in page.read_text()
    assert paper.read_bytes().startswith(b"%PDF")


def test_a_section_of_runs_leaves_sweeps_as_they_are(own_part, sweep12):
    own_part("section", "own", "def run_section(subject):\n    return None\n")
    assert "Section own" not in [section.title for section in sweep_document(sweep12).sections]


def test_a_section_receives_a_copy(own_part, finished):
    own_part("section", "own", "def run_section(subject):\n    subject.run.record.clear()\n")
    assert added_sections("run", RunSubject(finished)) == []
    assert finished.record


def test_a_section_is_not_a_part_of_a_run(own_part, finished):
    name = run_hash(finished.config, finished.urdf)
    own_part("section", str(finished.config["controller"]["kind"]), "def run_section(subject):\n    return None\n")
    assert run_hash(finished.config, finished.urdf) == name
    assert not has_users_parts()


def test_the_subject_of_a_run_is_the_run(finished):
    assert replace(RunSubject(finished)).run is finished
    assert RunSubject(open_run(finished.folder)).changed is not None
