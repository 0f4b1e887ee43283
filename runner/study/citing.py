"""BibTeX citation of a report and of its source."""

import re
from collections.abc import Mapping

from runner.reporting.document import Block, Code, Section, Text
from runner.store import Run

_SPECIAL = re.compile(r"[&%$#_{}~^\\]")


def citing_section(title: str, source: str, bibtex: str, runs: Mapping[str, Run]) -> Section:
    """Return how the report is cited, and its source where that is known.

    Args:
        title: Title of the study.
        source: Whose it is.
        bibtex: Entry of the source; empty where there is none.
        runs: The stored runs behind the report, by name.
    """
    newest = max(runs.values(), key=lambda run: str(run.provenance["date"]), default=None)
    blocks: list[Block] = [Text("The source:"), Code(bibtex.strip())] if bibtex.strip() else []
    return Section("Cite this", [*blocks, Text("This report:"), Code(_report(title, source, newest))])


def _report(title: str, source: str, newest: Run | None) -> str:
    provenance: Mapping[str, object] = {} if newest is None else newest.provenance
    commit, date = str(provenance.get("commit") or ""), str(provenance.get("date") or "")
    made = f"Made by arm-control-runner{f', commit {commit[:12]}' if commit else ''}{f', {date}' if date else ''}"
    key = "-".join(re.findall(r"[a-z0-9]+", title.lower())[:4])
    fields = {
        "title": f"{{{_plain(title)}}}: {_plain(source)}",
        "author": "{arm-control-runner}",
        **({"year": date[:4]} if date else {}),
        "note": _plain(made),
    }
    return "\n".join([f"@misc{{{key}-reproduced,", *(f"  {name} = {{{text}}}," for name, text in fields.items()), "}"])


def _plain(text: str) -> str:
    """Return a text in which no character has a meaning of its own in BibTeX."""
    return _SPECIAL.sub(lambda found: f"\\{found[0]}" if found[0] in "&%$#_{}" else " ", text)
