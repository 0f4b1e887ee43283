"""LaTeX tables with booktabs and siunitx."""

import re
from collections.abc import Iterable, Sequence

from runner.base.sanitize import plain
from runner.reporting.export.columns import BEYOND, MISSING, PaperColumn, ScaledUnit, Written, lay_out
from runner.reporting.export.fitting import fit
from runner.reporting.table import Table

_MEANT = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "^": r"\textasciicircum{}",
    "_": r"\_", "%": r"\%", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}",
    "|": r"\textbar{}", "[": "{[}", "]": "{]}", "*": "{*}", '"': "''", "`": r"\textasciigrave{}",
    BEYOND: r"$\infty$", MISSING: "--", "µ": r"\textmu{}", "\u2212": r"$-$", "×": r"$\times$", "°": r"\textdegree{}",
    "²": r"\textsuperscript{2}", "³": r"\textsuperscript{3}", "…": r"\ldots{}",
}  # fmt: skip
_UNITS = {
    "m": r"\metre", "mm": r"\milli\metre", "µm": r"\micro\metre", "s": r"\second", "ms": r"\milli\second",
    "µs": r"\micro\second", "N": r"\newton", "rad": r"\radian", "kg": r"\kilogram", "J": r"\joule", "W": r"\watt",
    "Hz": r"\hertz", "A": r"\ampere", "V": r"\volt", "K": r"\kelvin", "°": r"\degree", "%": r"\percent", "1": "",
}  # fmt: skip
_FACTOR = re.compile(r"(/?)([^\s/^]+)(?:\^(\d+))?")
_LATIN = 0x17F  # up to here pdfLaTeX has the letters


def write_latex(table: Table, caption: str, sources: Sequence[str], width: float | None = None) -> str:
    """Return a table as LaTeX: a tabular, with comments on packages, its origin and a caption.

    Args:
        table: The table.
        caption: Its caption.
        sources: Where it comes from, a comment each.
        width: Width that it has to fit, in mm; None for the letters of the page, without a limit.

    Raises:
        RunnerError: If it does not fit the width.
    """
    columns = lay_out(table)
    titles: Sequence[Sequence[str]] = [[each.head] for each in columns]
    edge, begin, end = "", [], ""
    if width is not None:
        titles, room, letters = fit(columns, width, _measured, at_edges=False)
        size = rf"\fontsize{{{letters:g}}}{{{1.2 * letters:g}}}\selectfont"
        edge, begin, end = "@{}", [rf"{{{size}\setlength{{\tabcolsep}}{{{room:g}pt}}%"], "}"
    tabular = [
        *begin,
        rf"\begin{{tabular}}{{{edge}{' '.join(map(_alignment, columns))}{edge}}}",
        r"\toprule",
        *_head(columns, titles),
        r"\midrule",
        *(_row(part for each in columns for part in _parts(each, each.cells[row])) for row in range(len(table.rows))),
        r"\bottomrule",
        rf"\end{{tabular}}{end}",
    ]
    comments = [
        r"Needs \usepackage{booktabs} and \usepackage{siunitx}, version 3 or later.",
        *sources,
        rf"\caption{{{escape_latex(caption)}}}",
    ]
    if any(ord(letter) > _LATIN for letter in "".join(tabular)):
        comments.insert(1, "Has letters that LuaLaTeX or XeLaTeX sets, and pdfLaTeX does not.")
    return "".join(f"% {plain(line)}\n" for line in comments) + "\n".join(tabular) + "\n"


def _alignment(column: PaperColumn) -> str:
    """Return the alignment of a column: numbers at the decimal marker, with room for the longest."""
    if column.unit is None:
        return "r" if column.kind == "number" else "l"
    numbers = [cell.text.partition(".") for cell in column.cells if _is_number(cell.text)]
    whole = max((len(text.lstrip("-")) for text, _, _ in numbers), default=1)
    places = max((len(text) for _, _, text in numbers), default=0)
    sign = "-" if any(text.startswith("-") for text, _, _ in numbers) else ""
    return f"S[table-format={sign}{whole}.{places}]" + (" l" if column.has_intervals else "")


def _measured(column: PaperColumn) -> list[list[str]]:
    """Return the strings in the one place, or the two places, of a column: numbers and intervals."""
    if column.unit is None:
        return [[cell.text for cell in column.cells]]
    parts = [[*(cell.text for cell in column.cells), "median"]]
    if column.has_intervals:
        parts.append([*(f"[{cell.low}, {cell.high}]" for cell in column.cells if cell.low), "95 % interval"])
    return parts


def _head(columns: Sequence[PaperColumn], titles: Sequence[Sequence[str]]) -> list[str]:
    """Return the rows of the head: titles with units, whose lines end in one row, and below them their parts."""
    is_split = any(each.has_intervals for each in columns)
    has_titles = any(each.title for each in columns if each.unit is not None)
    above: list[list[list[str]]] = []
    rules: list[str] = []
    below: list[str] = []
    for each, given in zip(columns, titles, strict=True):
        span, place = 1 + each.has_intervals, 1 + len(below)
        lines = _title(each, given)
        if each.unit is None:
            own, last = [[line] for line in lines[:-1]], lines[-1:]
        elif is_split or not each.title:
            shown = lines if each.title else []
            own = [[rf"\multicolumn{{{span}}}{{c}}{{{line}}}"] for line in shown]
            last = ["{median}", r"95\,\% interval"][:span]
        else:
            own, last = [[f"{{{line}}}"] for line in lines[:-1]], [f"{{{lines[-1]}}}"]
        above.append(own)
        rules += [] if each.unit is None else [rf"\cmidrule(lr){{{place}-{place + span - 1}}}"]
        below += last
    count = max(map(len, above))
    filled = [
        [[""] * (1 + each.has_intervals)] * (count - len(own)) + own for each, own in zip(columns, above, strict=True)
    ]
    rows = [_row(part for own in filled for part in own[line]) for line in range(count)]
    return [*rows, *([" ".join(rules)] if is_split and has_titles else []), _row(below)]


def _title(column: PaperColumn, lines: Sequence[str]) -> list[str]:
    """Return the lines of a title, its unit as siunitx sets it."""
    unit = "" if column.unit is None else unit_macro(column.unit)
    if not unit:
        return list(map(escape_latex, lines))
    before = lines[-1].removesuffix(f"({column.unit})").rstrip()
    return [*map(escape_latex, lines[:-1]), f"{escape_latex(before)} ({unit})".strip()]


def _parts(column: PaperColumn, cell: Written) -> list[str]:
    """Return the entries of a cell: one place, or two in a column with intervals."""
    text = escape_latex(cell.text) if cell.unit is None else unit_macro(cell.unit)
    if column.unit is None:
        return [text]
    ends = [rf"\num{{{end}}}" if _is_number(end) else escape_latex(end) for end in (cell.low, cell.high)]
    interval = f"{{[}}{ends[0]}, {ends[1]}{{]}}" if cell.low else ""
    return [cell.text if _is_number(cell.text) else f"{{{text}}}", interval][: 1 + column.has_intervals]


def _is_number(text: str) -> bool:
    return bool(text) and text not in (BEYOND, f"-{BEYOND}", MISSING)


def _row(cells: Iterable[str]) -> str:
    return " & ".join(cells).strip() + r" \\"


def unit_macro(unit: ScaledUnit) -> str:
    """Return a unit as siunitx sets it, its own letters where siunitx has no name for it; nothing for 1."""
    factors = _FACTOR.findall(unit.name)
    known = all(name in _UNITS for _, name, _ in factors)
    macros = "".join(_factor(*factor) for factor in factors) if known else ""
    if unit.power:
        return rf"\qty{{e{unit.power}}}{{{macros}}}" if macros else rf"\num{{e{unit.power}}} {_own(unit)}".strip()
    return rf"\unit{{{macros}}}" if macros else _own(unit)


def _own(unit: ScaledUnit) -> str:
    return "" if unit.name == "1" else escape_latex(unit.name)


def _factor(divided: str, name: str, exponent: str) -> str:
    return (r"\per" if divided else "") + _UNITS[name] + (rf"\tothe{{{exponent}}}" if exponent else "")


def escape_latex(text: str) -> str:
    """Return a string in which LaTeX finds no markup."""
    return "".join(_MEANT.get(letter, letter) for letter in plain(text))
