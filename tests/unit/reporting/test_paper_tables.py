"""Tables for papers as Markdown and LaTeX: rows, notes, units and escapes."""

import re
from dataclasses import replace

import numpy as np
import pytest
from support.paper_sweep import by_hand

from runner.base.errors import RunnerError
from runner.reporting.export.columns import ScaledUnit, lay_out
from runner.reporting.export.columns import escape_markdown as markdown_escaped
from runner.reporting.export.fitting import fit
from runner.reporting.export.latex import escape_latex as latex_escaped
from runner.reporting.export.latex import unit_macro
from runner.reporting.export.paper_table import of_sweep
from runner.statistics import median_interval
from runner.store.axes import Axis

COMMAND = "runner -m controller=computed_torque,operational_space"
NAMES = ["rms_tracking_error", "peak_torque"]
PACKAGES = ("begin", "end", "toprule", "midrule", "bottomrule", "cmidrule", "multicolumn", "num", "unit", "qty", "per",
            "tothe", "metre", "milli", "newton", "textsuperscript")  # fmt: skip


def table(sweep=None, metrics=NAMES, **options):
    return of_sweep(sweep or by_hand(), COMMAND, metrics, **options)


def markdown(made):
    return made.written("markdown")


def latex(made):
    return made.written("latex")


def markdown_rows(text):
    lines = [line for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


def test_markdown_has_a_row_for_each_combination_with_numbers_of_the_sweep():
    rows = markdown_rows(markdown(table()))
    assert rows[0] == ["controller", "robot.payload.mass (kg)", "rms tracking error (mm)",
                       "largest torque (N\u00a0m)"]  # fmt: skip
    assert rows[1] == ["---", "---", "---:", "---:"]
    assert [row[:2] for row in rows[2:]] == [["computed_torque", "0.5"], ["computed_torque", "2"],
                                             ["operational_space", "0.5"], ["operational_space", "2"]]  # fmt: skip
    values = by_hand().values["rms_tracking_error"][3:6].ravel()
    expected = median_interval(values)
    shown = [float(text) for text in re.findall(r"[\d.]+", rows[3][2])]
    assert shown == pytest.approx([1e3 * each for each in (expected.median, expected.low, expected.high)], abs=6e-3)


def test_the_notes_say_how_and_of_what():
    text = markdown(table())
    assert "n = 12 repetitions from 3 seeds behind each median." in text
    assert "95 % interval: percentile bootstrap of 9999 resamples" in text
    assert f"From: {COMMAND}" in text
    assert "Commit: abc" in text
    assert "robot=macro" in text


def test_failures_and_caveats_are_told():
    sweep = by_hand()
    values = {name: np.where(np.arange(12)[:, None] == 0, np.inf, rows) for name, rows in sweep.values.items()}
    caveats = [[{"rule": "saturation"}], *[[]] * 11]
    failed = replace(
        sweep, statuses=["failed", *["ok"] * 11], failures=["it diverged", *[""] * 11], values=values, caveats=caveats
    )
    text = markdown(table(failed))
    assert "8 of 96 values are missing" in text
    assert "1 of 12 cells failed." in text
    assert "1 of 12 cells have caveats: saturation." in text


def test_values_of_undefined_metrics_are_counted_as_missing():
    sweep = by_hand()
    sweep.values["peak_torque"][:3] = np.nan
    undefined = np.isnan(sweep.values["peak_torque"])
    text = markdown(table(replace(sweep, undefined={"peak_torque": undefined})))
    assert "12 of 96 values are missing, as the runs do not define their metric (–)." in text


def test_counts_stand_in_a_column_where_they_differ():
    sweep = by_hand()
    for values in sweep.values.values():
        values[0] = np.nan
    rows = markdown_rows(markdown(table(sweep)))
    assert rows[0][-1] == "n"
    assert [row[-1] for row in rows[2:]] == ["8", "12", "12", "12"]


def test_few_repetitions_have_no_interval_and_a_note_says_why():
    sweep = by_hand()
    few = replace(sweep, values={name: values[:, :1] for name, values in sweep.values.items()})
    for text in (markdown(table(few)), latex(table(few))):
        assert "No interval is given if n is below 6" in text
    assert "cmidrule" not in latex(table(few))
    assert "interval}" not in latex(table(few))


def sound(text):
    """Check a LaTeX table as far as that goes without TeX: braces, columns, numbers that siunitx reads."""
    body = "\n".join(line for line in text.splitlines() if not line.startswith("%"))
    bare = re.sub(r"\\[{}]", "", body)
    assert bare.count("{") == bare.count("}")
    assert body.count(r"\begin{tabular}") == body.count(r"\end{tabular}") == 1
    head = re.search(r"\\begin\{tabular\}\{(.*)\}\n", body)[1]
    widths = [(int(whole), int(places)) for whole, places in re.findall(r"S\[table-format=-?(\d+)\.(\d+)\]", head)]
    kinds = re.sub(r"S\[[^]]*\]", "S", head).replace(" ", "")
    assert set(kinds) <= set("lSr")
    rules = ("\\begin", "\\end", "\\toprule", "\\midrule", "\\bottomrule", "\\cmidrule")
    for line in body.splitlines():
        if line.startswith(rules):
            continue
        assert line.endswith(r" \\")
        assert not line.startswith(("[", "*"))  # an argument of the row's end before it
        cells = re.split(r"(?<!\\)&", line.removesuffix(r"\\"))
        spans = sum(int(span) - 1 for span in re.findall(r"\\multicolumn\{(\d)\}", line))
        assert len(cells) + spans == len(kinds), line
        if spans or "{median}" in line:
            continue
        numbers = [cell.strip() for cell, kind in zip(cells, kinds, strict=True) if kind == "S"]
        for number, (whole, places) in zip(numbers, widths, strict=True):
            if number.startswith("{"):
                assert number.endswith("}")
                continue
            before, _, after = number.lstrip("-").partition(".")
            assert before.isdigit()
            assert len(before) <= whole
            assert len(after) <= places
    for argument in re.findall(r"\\num\{([^}]*)\}", body):
        assert re.fullmatch(r"-?\d+(\.\d+)?|e-?\d+", argument)
    return body


def test_latex_is_a_sound_tabular_of_booktabs_and_siunitx():
    text = latex(table(metrics=[*NAMES, "own_cost"]))
    body = sound(text)
    assert set(re.findall(r"\\([a-z]+)", body)) <= {*PACKAGES, "textasciicircum"}
    assert r"% Needs \usepackage{booktabs} and \usepackage{siunitx}, version 3 or later." in text
    assert r"\multicolumn{2}{c}{rms tracking error (\unit{\milli\metre})}" in body
    assert r"computed\_torque & 0.5 & " in body


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        (ScaledUnit("1"), ""),
        (ScaledUnit("N m"), r"\unit{\newton\metre}"),
        (ScaledUnit("m/s^2"), r"\unit{\metre\per\second\tothe{2}}"),
        (ScaledUnit("N^2 m^2 s", 3), r"\qty{e3}{\newton\tothe{2}\metre\tothe{2}\second}"),
        (ScaledUnit("1", -6), r"\num{e-6}"),
        (ScaledUnit("GBP/m^2", -9), r"\num{e-9} GBP/m\textasciicircum{}2"),
        (ScaledUnit("a_b"), r"a\_b"),
    ],
)
def test_units_are_those_of_siunitx(unit, expected):
    assert unit_macro(unit) == expected


HOSTILE = [r"\input{x}", "a & b", "50% {x", "$x$", "[opt]", "*", "a_b^c~d#e", "<b>|`", "line\nbreak", 'qu"ote', "\\\\"]


@pytest.mark.parametrize("text", HOSTILE)
def test_no_text_means_anything(text):
    sweep = by_hand()
    axes = [Axis("controller", [text, "other"], sweep.axes[0].level), *sweep.axes[1:]]
    hostile = replace(sweep, axes=axes, fixed=[f"x={text}"])
    sound(latex(table(hostile)))
    lines = latex(of_sweep(hostile, text, NAMES)).splitlines()
    assert [line for line in lines if line.startswith("%")] == lines[:4]
    rows = markdown_rows(markdown(table(hostile)))
    assert {len(row) for row in rows} == {4}


def test_escapes_by_hand():
    assert latex_escaped("a_b & 5% \\x{}") == r"a\_b \& 5\% \textbackslash{}x\{\}"
    assert latex_escaped("∞ [1]") == r"$\infty$ {[}1{]}"
    assert markdown_escaped("computed_torque _x_ a|b <i> *") == r"computed_torque \_x\_ a\|b &lt;i&gt; \*"


def test_letters_that_pdflatex_lacks_are_told():
    sweep = by_hand()
    axes = [Axis("controller", ["控制", "other"], sweep.axes[0].level), *sweep.axes[1:]]
    assert "LuaLaTeX" in latex(table(replace(sweep, axes=axes)))
    assert "LuaLaTeX" not in latex(table())


def test_missing_numbers_stand_in_braces():
    sweep = by_hand()
    sweep.values["peak_torque"][:3] = np.inf
    sweep.values["rms_tracking_error"][3:6] = np.nan
    body = sound(latex(table(sweep)))
    assert r"{$\infty$}" in body
    assert "{--}" in body


def test_metrics_are_those_of_the_report_where_none_is_named():
    titles = [column.title for column in table(metrics=None).table.columns]
    assert titles[2:] == ["largest torque", "rms tracking error", "own cost"]


def test_unknown_metrics_are_refused():
    with pytest.raises(RunnerError, match=r"unknown metric 'peak_torq'\. Allowed: rms_"):
        table(metrics=["peak_torq"])


def test_markdown_has_no_bracket_that_begins_a_formula():
    """Fault 12: pandoc takes a bracket behind a backslash, as in R Markdown, for display mathematics."""
    text = markdown(table())
    assert r"\[" not in text
    assert re.search(r"\| [\d.]+ \([\d.]+ to [\d.]+\) \|", text)
    assert markdown_escaped("a[1] #2") == "a&#91;1&#93; &#35;2"


@pytest.mark.parametrize("width", [84.0, 88.0, 180.0])
def test_a_table_within_a_width_has_small_letters_and_titles_in_lines(width):
    made = table(by=["controller"], where=["robot.payload.mass=0.5"])
    text = made.written("latex", width)
    body = "\n".join(line for line in text.splitlines() if not line.startswith("%"))
    assert body.startswith(r"{\fontsize{8}{9.6}\selectfont\setlength{\tabcolsep}{")
    assert body.rstrip().endswith(r"\end{tabular}}")
    assert r"\begin{tabular}{@{}l S" in body
    sound(re.sub(r"^\{.*%\n", "", body.replace(r"\end{tabular}}", r"\end{tabular}").replace("@{}", "")))
    assert ("tracking error (" in body) == (width > 86.0)  # else the unit is in another line
    typst = made.written("typst", width)
    assert "text(8pt, table(" in typst
    cells = re.findall(r'"([^"]*)"', typst.partition("table.hline(stroke")[2])
    assert [cell for cell in cells if " " in cell] == []  # none is broken: a space is a no-break space
    assert "(N\u00a0m)" in typst


def test_a_table_that_does_not_fit_names_the_width_it_needs():
    made = table(metrics=[*NAMES, "own_cost"])
    with pytest.raises(RunnerError, match=r"--width: the table needs (\d+) mm, and 88 mm are allowed\.") as caught:
        made.written("latex", 88.0)
    needed = float(re.search(r"needs (\d+) mm", str(caught.value))[1])
    assert made.written("latex", needed)
    with pytest.raises(RunnerError, match="fewer metrics"):
        made.written("typst", 88.0)


def test_the_readmes_table_fits_a_column_by_the_letters_of_latex():
    """Fault 5: 17 pt into the other column of an IEEE paper."""
    columns = lay_out(table(by=["controller"], where=["robot.payload.mass=0.5"]).table)
    fitted = fit(columns, 88.0, lambda each: [[cell.with_interval("[{}, {}]") for cell in each.cells]], at_edges=False)
    assert 2.0 <= fitted.room <= 5.0
    assert fitted.titles[0] == ["controller"]


def test_without_a_width_letters_and_room_are_those_of_the_page():
    assert "fontsize" not in latex(table())
    assert "8pt" not in table().written("typst")
