"""Exports in the programs that authors use: LaTeX, Typst, pandoc, polars, DuckDB and Chromium, where installed."""

import itertools
import re
import shutil
import subprocess
from importlib.util import find_spec

import pytest
import typst
from support.patience import PATIENCE
from support.pdf_text import letter_sizes

from runner.base.paths import examples_dir

CLASSES = ["[conference]{IEEEtran}", "[journal]{IEEEtran}", "[5p,twocolumn]{elsarticle}", "{llncs}"]
RUN = ("robot=macro", "controller=computed_torque,operational_space", "trajectory=quintic", "noise=thesis",
       "repetitions=10")  # fmt: skip
TABLE = ("--by", "controller", "--metrics", "max_tracking_error,peak_torque", "--width", "single")
SMALLEST = 7.0  # pt, of a letter on a printed page

pytestmark = pytest.mark.slow


def program(name):
    """Return the place of a program; skip the test, and say why, where it is not installed."""
    return shutil.which(name) or pytest.skip(f"{name} is not installed")


@pytest.fixture
def exported(cli, tmp_path, monkeypatch):
    """Return a folder with the figures and tables of the README's comparison, and its report."""
    monkeypatch.chdir(tmp_path)
    swept = cli("-m", *RUN).folder
    assert cli("figures", swept, "--output", "figures").code == 0
    for name in ("table.tex", "table.typ"):
        assert cli("table", swept, *TABLE, "--output", name).code == 0
    assert cli("table", swept, "--format", "markdown", "--output", "table.md").code == 0
    return tmp_path, swept


@pytest.mark.parametrize("kind", CLASSES)
def test_latex_sets_figure_and_table_within_the_column(exported, kind):
    latex, fonts = program("pdflatex"), program("pdffonts")
    for package in (re.search(r"\{(\w+)\}", kind)[1] + ".cls", "siunitx.sty", "booktabs.sty"):
        if subprocess.run([program("kpsewhich"), package], capture_output=True, check=False).returncode:
            pytest.skip(f"{package} is not installed")
    folder, _ = exported
    figures = sorted(path.stem for path in (folder / "figures").glob("*.pdf"))
    drawn = "\n".join(
        rf"\begin{{figure}}\includegraphics{{figures/{name}.pdf}}\caption{{x}}\end{{figure}}" for name in figures
    )
    (folder / "paper.tex").write_text(
        rf"""\documentclass{kind}
\usepackage{{booktabs}}\usepackage{{siunitx}}\usepackage{{graphicx}}
\begin{{document}}\pagestyle{{empty}}
\begin{{table}}\centering\caption{{X}}\input{{table}}\end{{table}}
{drawn}
Text.
\end{{document}}
"""
    )
    made = subprocess.run(
        [latex, "-interaction=nonstopmode", "-halt-on-error", "paper.tex"], cwd=folder, capture_output=True, check=False
    )
    told = made.stdout.decode(errors="replace")
    assert made.returncode == 0, told[-2000:]
    assert [float(size) for size in re.findall(r"Overfull \\hbox \(([\d.]+)pt", told) if float(size) > 1.0] == []
    assert "PDF inclusion: found PDF version" not in told
    listed = subprocess.run([fonts, "paper.pdf"], cwd=folder, capture_output=True, text=True, check=True).stdout
    assert "Type 3" not in listed
    boxes = subprocess.run(
        [program("pdftotext"), "-bbox-layout", "paper.pdf", "-"], cwd=folder, capture_output=True, text=True, check=True
    ).stdout
    assert "operational_space" in boxes
    sizes = list(letter_sizes((folder / "paper.pdf").read_bytes()))
    assert {letter for letter, size in sizes if size < SMALLEST} == set()
    drawings = [list(letter_sizes((folder / "figures" / f"{name}.pdf").read_bytes())) for name in figures]
    assert sum(len(letters) > 50 for letters in drawings) > 5  # letters of figures are text, which is measured


def test_typst_sets_the_table_of_a_two_column_page_without_overprinting(exported):
    folder, _ = exported
    (folder / "page.typ").write_text(
        '#set page(paper: "a4", columns: 2, margin: (x: 14mm))\n#set columns(gutter: 6mm)\n#include "table.typ"\n'
        "#colbreak()\nSECOND"
    )
    typst.compile(folder / "page.typ", output=folder / "page.pdf", root=folder, format="pdf", ignore_system_fonts=True)
    words = subprocess.run(
        [program("pdftotext"), "-bbox", "page.pdf", "-"], cwd=folder, capture_output=True, text=True, check=True
    ).stdout
    places = re.findall(r'xMin="([\d.]+)" yMin="([\d.]+)" xMax="([\d.]+)" yMax="[\d.]+">([^<]*)<', words)
    second = min(float(low) for low, _, _, word in places if word == "SECOND")
    assert max(float(high) for low, _, high, word in places if word != "SECOND") < second
    assert sum("1." in word or "0." in word for *_, word in places) >= 4
    rows = {}
    for low, top, high, _ in places:
        rows.setdefault(round(float(top)), []).append((float(low), float(high)))
    for row in rows.values():
        row.sort()
        assert all(one[1] <= other[0] + 0.1 for one, other in itertools.pairwise(row))


def test_the_example_of_a_paper_is_of_two_pages(exported):
    folder, _ = exported
    shutil.copy(examples_dir() / "paper" / "paper.typ", folder)
    assert len(typst.compile(folder / "paper.typ", root=folder, format="svg", ignore_system_fonts=True)) == 2


def test_pandoc_reads_the_table_of_r_markdown_without_a_formula(exported):
    folder, _ = exported
    read = ["-f", "markdown+tex_math_single_backslash", "-t", "html", "table.md"]
    html = subprocess.run([program("pandoc"), *read], cwd=folder, capture_output=True, text=True, check=True).stdout
    assert "math display" not in html
    assert re.search(r"[\d.]+ \([\d.]+ to [\d.]+\)", html)


def test_polars_and_duckdb_read_numbers_as_numbers(exported):
    for package in ("polars", "duckdb"):
        if find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    import duckdb
    import polars

    folder, _ = exported
    files = [path for path in sorted((folder / "figures").glob("*.csv")) if path.stem != "motion"]
    assert files
    for path in files:
        numbers = {"y", "low", "median", "high", "value"} & set(path.read_text().partition("\n")[0].strip().split(","))
        frame = polars.read_csv(path)
        kinds = dict(zip(frame.columns, frame.dtypes, strict=True))
        found = dict(duckdb.sql(f"select column_name, column_type from (describe select * from '{path}')").fetchall())
        for name in numbers:
            if frame[name].null_count() < len(frame):  # a column without any number has no kind
                assert kinds[name] == polars.Float64, (path.name, name)
                assert found[name] == "DOUBLE", (path.name, name)


def test_chromium_prints_a_report_with_nothing_cut(exported, cli):
    browser = program("chromium")
    folder, swept = exported
    report = cli("report", swept).folder
    subprocess.run(
        [browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}",
         "--no-pdf-header-footer", f"--print-to-pdf={folder / 'printed.pdf'}", "--virtual-time-budget=20000",
         (report / "report.html").as_uri()],
        capture_output=True, check=True, timeout=PATIENCE,
    )  # fmt: skip
    text = subprocess.run(
        [program("pdftotext"), "-layout", "printed.pdf", "-"], cwd=folder, capture_output=True, text=True, check=True
    ).stdout
    assert "Compared in pairs" in text
    words = subprocess.run(
        [program("pdftotext"), "-bbox", "printed.pdf", "-"], cwd=folder, capture_output=True, text=True, check=True
    ).stdout
    width = float(re.search(r'<page width="([\d.]+)"', words)[1])
    assert max(float(right) for right in re.findall(r'xMax="([\d.]+)"', words)) < width
