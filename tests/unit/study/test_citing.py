"""Citations of a source and of the report on it, as BibTeX."""

from support.made_up_runs import made_up_run

from runner.papers.study.report import citing_section
from runner.reporting.document import Code


def codes(section):
    return [block.text for block in section.blocks if isinstance(block, Code)]


def test_the_source_and_the_report_with_the_newest_run():
    runs = {"a": made_up_run(date="2026-01-01", commit="0" * 40), "b": made_up_run(date="2026-02-03", commit="f" * 40)}
    source, report = codes(citing_section("Arms & hands", "A report", "@misc{x,}\n", runs))
    assert source == "@misc{x,}"
    assert report.splitlines() == [
        "@misc{arms-hands-reproduced,",
        "  title = {{Arms \\& hands}: A report},",
        "  author = {{arm-control-runner}},",
        "  year = {2026},",
        "  note = {Made by arm-control-runner, commit ffffffffffff, 2026-02-03},",
        "}",
    ]


def test_without_runs_and_source():
    (report,) = codes(citing_section("A_{b}%", "c", "", {}))
    assert "year" not in report
    assert "{{A\\_\\{b\\}\\%}: c}" in report
