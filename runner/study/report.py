"""Report on a study: chapters, provenance, caveats, checklist and citation in BibTeX."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from runner.reporting.document import Block, Code, Cover, Document, Notice, Provenance, Section, Table, Text, Verdicts
from runner.reporting.markup import literal, literals
from runner.reporting.outline import number_sections
from runner.reporting.run_report import provenance
from runner.reporting.tally import find_conditional_claims
from runner.store import Calibration, Run
from runner.study.checklist import Checklist
from runner.study.expected_caveats import ExpectedCaveat, caveats_section, unexpected_caveats
from runner.study.job import LeftOutError, MissingError, Results, distinct


def study_document(
    title: str,
    subtitle: str,
    abstract: str,
    chapters: Sequence[Section],
    runs: Mapping[str, Run],
    calibrations: Mapping[str, Calibration],
    expected: Sequence[ExpectedCaveat],
    checklist: Checklist | None,
    code: str,
    cover: Cover | None = None,
    bibtex: str = "",
) -> Document:
    """Return the report on a study.

    Args:
        title: The study's title.
        subtitle: Whose it is.
        abstract: What comes out; inline mathematics as in Text.
        chapters: The report's own chapters.
        runs: The stored runs of the study's plan, by name.
        calibrations: The stored calibrations of the study, by name.
        expected: The caveats that the study expects of them.
        checklist: What of the study is to stand where, for the last chapter; None where the study has no list.
        code: What is to be said of the study's own code; nothing where it has none.
        cover: The picture of the first screen.
        bibtex: BibTeX entry of the source; empty where there is none.
    """
    missing = [_missing(runs.missing)] if isinstance(runs, Results) and runs.missing else []
    sections = [*missing, *chapters, caveats_section(runs, expected), _where_from(runs, calibrations, code)]
    date = max((str(run.provenance["date"]) for run in runs.values()), default="")
    listed = [checklist.section(sections)] if checklist else []
    everything = [*sections, *listed, citing_section(title, subtitle, bibtex, runs)]
    return Document(title, subtitle, abstract, everything, date, cover, _notes(chapters, runs, expected))


def _notes(chapters: Sequence[Section], runs: Mapping[str, Run], expected: Sequence[ExpectedCaveat]) -> list[str]:
    """Return what the words of verdicts mean, what these hang on, and how many caveats the runs have."""
    blocks = [block for each in number_sections(chapters) for block in each.section.blocks]
    legends = dict.fromkeys(block.legend for block in blocks if isinstance(block, Verdicts))
    everything = distinct(runs)
    carrying = sum(bool(run.caveats) for run in everything)
    strange = len(unexpected_caveats(runs, expected))
    told = f"{strange} caveats are not expected" if strange else "all of them expected and explained"
    caveats = f"Caveats: {carrying} of {len(everything)} runs carry some, {told}." if carrying else ""
    return [text for text in (*legends, find_conditional_claims(blocks), caveats) if text]


def _where_from(runs: Mapping[str, Run], calibrations: Mapping[str, Calibration], code: str) -> Section:
    count, found = len(distinct(runs)), len(distinct(calibrations))
    more, folders = (f" and {found} calibrations", " and outputs/calibrations") if calibrations else ("", "")
    text = (
        f"{count} runs{more} lie behind this report, each stored with its config, trace and metrics under "
        f"outputs/runs{folders}. Figures show repetition 0; numbers are medians over the repetitions."
    )
    blocks: list[Block] = [Text(text)]
    if runs:
        rows = provenance(list(runs.values())).rows
        blocks.append(Provenance([*rows, *([("code of the study", code)] if code else [])]))
    return Section("Provenance", blocks)


def parts(makers: Iterable[tuple[str, Callable[[], Section]]]) -> list[Section]:
    """Return chapters or sections, made one by one; one that needs what was not made says so instead.

    Args:
        makers: What each of them is called where it is left out, such as its file, and what makes it.
    """
    found = []
    for name, make in makers:
        try:
            found.append(make())
        except LeftOutError as error:
            text = f"The profile makes less than this part needs: {literal(str(error))}."
            found.append(Section(f"Left out: {literal(name)}", (Text(text),)))
        except MissingError as error:
            notice = Notice("failure", "Left out", f"This part needs what was not made: {literal(str(error))}.")
            found.append(Section(f"Left out: {literal(name)}", (notice,)))
    return found


def _missing(missing: Mapping[str, str]) -> Section:
    rows = [literals(item) for item in missing.items()]
    table = Table("Not made, and so missing in this report; the same command makes them.", ["name", "why"], rows)
    return Section("What is missing", (table,))


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
