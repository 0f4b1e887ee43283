"""Progress stages common to several packages, with their expected durations."""

from collections.abc import Collection

CHECKING, SIMULATING = "checking", "simulating"
AUDITING, BELIEVING = "auditing", "trying"
PREPARING, READING, CHAPTERS = "preparing the report", "reading runs", "writing chapters"
HTML, FIGURES, PDF = "writing the HTML", "drawing figures", "setting the PDF"

SOON = 0.5
"""Time of what takes little as a rule, in s."""

REPORT_CODE = 2.0
"""Time to read the code that makes reports, in s."""

_USUAL = 10  # figures of a report that is not made yet
# Times in s, as measured on two cores of a server; how long all takes here, the clock shows.
_CHECKED, _TOLD = 0.05, 0.03  # of each cell or run of a study: to check it; to read it and to write of it
_PAGE, _PLAYED = 0.4, 0.01  # of the HTML, and of each figure in it
_DRAWN = 0.13  # of a figure for the PDF
_SET, _PLACED = 0.1, 0.03  # of the PDF, and of each figure in it


def of_report(formats: Collection[str], figures: int = _USUAL) -> dict[str, float]:
    """Return the stages of writing a report in some formats, each with the time that it is expected to take, in s."""
    html = {HTML: _PAGE + _PLAYED * figures} if "html" in formats else {}
    pdf = {FIGURES: _DRAWN * figures, PDF: _SET + _PLACED * figures} if "pdf" in formats else {}
    return html | pdf


def of_audit() -> dict[str, float]:
    """Return the stages of the audit of all studies, with its report, likewise."""
    return {AUDITING: 8.0, BELIEVING: 10.0, **of_report(("html", "pdf"))}


def of_study(runs: int) -> dict[str, float | None]:
    """Return the stages of making a study of so many runs, with its report, likewise; None of what is not known yet."""
    return {
        CHECKING: _CHECKED * runs,
        SIMULATING: None,
        CHAPTERS: SOON + _TOLD * runs,
        **of_report(("html", "pdf")),
    }
