"""LaTeX tables with booktabs and siunitx."""

import re
from collections.abc import Iterable

from runner.base.sanitize import plain
from runner.reporting.export.columns import BEYOND, MISSING, Cell, Column, Unit
from runner.reporting.export.paper_table import Label, PaperTable

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


def latex(table: PaperTable) -> str:
    """Return the table as LaTeX: a tabular, with comments on packages, origin and how its numbers were made."""
    counts = table.counts
    columns = [*("l" for _ in table.heads), *map(_column, table.columns), *("r" if counts else "")]
    body = [
        _row([*map(_label, labels), *(part for each in table.columns for part in _numbers(each, row)),
              *([escape_latex(counts[row])] if counts else [])])
        for row, labels in enumerate(table.labels)
    ]  # fmt: skip
    tabular = [
        rf"\begin{{tabular}}{{{' '.join(columns)}}}",
        r"\toprule",
        *_head(table),
        r"\midrule",
        *body,
        r"\bottomrule",
        r"\end{tabular}",
    ]
    comments = [
        r"Needs \usepackage{booktabs} and \usepackage{siunitx}, version 3 or later.",
        *(source for source in table.sources),
        rf"\caption{{{escape_latex(' '.join(table.notes))}}}",
    ]
    if any(ord(letter) > _LATIN for letter in "".join(tabular)):
        comments.insert(1, "Has letters that LuaLaTeX or XeLaTeX sets, and pdfLaTeX does not.")
    return "".join(f"% {plain(line)}\n" for line in comments) + "\n".join(tabular) + "\n"


def _column(column: Column) -> str:
    """Return the alignment of a metric: at the decimal marker, with room for its longest numbers."""
    numbers = [cell.median.partition(".") for cell in column.cells if _is_number(cell.median)]
    whole = max((len(text.lstrip("-")) for text, _, _ in numbers), default=1)
    places = max((len(text) for _, _, text in numbers), default=0)
    sign = "-" if any(text.startswith("-") for text, _, _ in numbers) else ""
    return f"S[table-format={sign}{whole}.{places}]" + (" l" if column.has_intervals else "")


def _head(table: PaperTable) -> list[str]:
    """Return the rows of the head: titles with units, and below them the parts of each."""
    titles = [_braced(_title(each)) for each in table.columns]
    last = ["n"] if table.counts else []
    if not any(each.has_intervals for each in table.columns):
        parts = [title if each.title else "{median}" for title, each in zip(titles, table.columns, strict=True)]
        return [_row([*map(escape_latex, table.heads), *parts, *last])]
    parts = [part for each in table.columns for part in (["{median}", r"95\,\% interval"][: 1 + each.has_intervals])]
    below = _row([*map(escape_latex, table.heads), *parts, *last])
    if not any(each.title for each in table.columns):
        return [below]
    above, rules, place = ["" for _ in table.heads], [], len(table.heads) + 1
    for title, each in zip(titles, table.columns, strict=True):
        span = 1 + each.has_intervals
        above.append(rf"\multicolumn{{{span}}}{{c}}{title}")
        rules.append(rf"\cmidrule(lr){{{place}-{place + span - 1}}}")
        place += span
    return [_row([*above, *("" for _ in last)]), " ".join(rules), below]


def _title(column: Column) -> str:
    unit = unit_macro(column.unit)
    return f"{escape_latex(column.title)} ({unit})" if unit else escape_latex(column.title)


def _label(label: Label) -> str:
    return unit_macro(label) if isinstance(label, Unit) else escape_latex(label)


def _numbers(column: Column, row: int) -> list[str]:
    cell = column.cells[row]
    median = cell.median if _is_number(cell.median) else _braced(escape_latex(cell.median))
    return [median, _interval(cell)] if column.has_intervals else [median]


def _interval(cell: Cell) -> str:
    if not cell.low:
        return ""
    low, high = (rf"\num{{{end}}}" if _is_number(end) else escape_latex(end) for end in (cell.low, cell.high))
    return f"{{[}}{low}, {high}{{]}}"


def _is_number(text: str) -> bool:
    return bool(text) and text not in (BEYOND, f"-{BEYOND}", MISSING)


def _row(cells: Iterable[str]) -> str:
    return " & ".join(cells).strip() + r" \\"


def _braced(text: str) -> str:
    return f"{{{text}}}"


def unit_macro(unit: Unit) -> str:
    """Return a unit as siunitx sets it, its own letters where siunitx has no name for it; nothing for 1."""
    factors = _FACTOR.findall(str(unit))
    known = all(name in _UNITS for _, name, _ in factors)
    macros = "".join(_factor(*factor) for factor in factors) if known else ""
    if unit.power:
        return rf"\qty{{e{unit.power}}}{{{macros}}}" if macros else rf"\num{{e{unit.power}}} {_own(unit)}".strip()
    return rf"\unit{{{macros}}}" if macros else _own(unit)


def _own(unit: Unit) -> str:
    return "" if unit == "1" else escape_latex(str(unit))


def _factor(divided: str, name: str, exponent: str) -> str:
    return (r"\per" if divided else "") + _UNITS[name] + (rf"\tothe{{{exponent}}}" if exponent else "")


def escape_latex(text: str) -> str:
    """Return a string in which LaTeX finds no markup."""
    return "".join(_MEANT.get(letter, letter) for letter in plain(text))
