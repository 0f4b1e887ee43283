"""Figures of a report as files: their names, letters, sizes, and any string in them."""

import re
import zlib
from xml.etree import ElementTree

import numpy as np
import pytest
from support.sample_document import HOSTILE, SVG, curves, document, maps, playback

from runner.base.errors import RunnerError
from runner.reporting.charts.sheet import column
from runner.reporting.document import Curves, Document, Maps, Origin, Panel, Picture, Section, Series
from runner.reporting.export.figures import as_csv, choose_figures, figures_of, for_paper, tell_widths, write_figures
from runner.reporting.figures import playback as still_of
from runner.reporting.figures import still_motion

SHEETS = {88.0: column(88.0), 180.0: column(180.0)}
POINTS = 72.0 / 25.4  # in a millimetre


def report(*blocks):
    return Document("t", "", "", [Section("First", blocks)], "2026-01-01")


def written(folder, blocks, sheet=SHEETS[88.0], only=None):
    return list(write_figures(choose_figures(figures_of(report(*blocks)), only), folder, sheet))


def letters(pdf):
    """Return the sizes in which a PDF of matplotlib's sets letters."""
    streams = re.findall(rb"stream\r?\n(.*?)endstream", pdf, re.S)
    texts = []
    for stream in streams:
        try:
            texts.append(zlib.decompress(stream))
        except zlib.error:
            texts.append(stream)
    return {float(size) for text in texts for size in re.findall(rb"/F\d+ ([\d.]+) Tf", text)}


def size_of(pdf):
    (box,) = re.findall(rb"/MediaBox ?\[ ?([\d. ]+)\]", pdf)
    return [float(number) for number in box.split()][2:]


def test_each_figure_has_its_files_and_is_named_as_in_the_report(tmp_path):
    x = np.linspace(0.0, 1.0, 5)
    panels = [Panel("", "time (s)", f"{word} (N m)", [Series("", x, x)]) for word in ("largest torque", "largest load")]
    blocks = [Curves("Both.", panels), Curves("Both.", panels), maps("m", origin=Origin("3.5")), playback(),
              Picture("The frames. More.", SVG, "alt")]  # fmt: skip
    names = written(tmp_path, blocks)
    both = "largest-torque-and-load-over-time"
    assert names == [both, f"{both}-2", "figure-3-5-map-of-m-by-m", "motion", "the-frames"]
    kinds = {name: sorted(path.suffix for path in tmp_path.glob(f"{name}.*")) for name in names}
    assert list(kinds.values()) == [[".csv", ".pdf", ".svg", ".txt"]] * 4 + [[".pdf", ".svg", ".txt"]]


def test_titles_of_panels_are_in_the_caption_and_letters_in_the_figure():
    figure, caption = for_paper(maps("m $$ $omega$"))
    assert [panel.title for panel in figure.panels] == ["(a)", "(b)"]
    assert caption == "m $ omega (a) m $$ $omega$; (b) m $$ $omega$."
    assert for_paper(curves("m", panels=[curves("m").panels[0]]))[1] == "m M."
    assert for_paper(playback())[1] == "It moves."


@pytest.mark.parametrize("width", SHEETS)
@pytest.mark.parametrize("block", [curves("error"), maps("error")], ids=["curves", "maps"])
def test_letters_are_of_8_points_and_embedded_at_any_width(block, width, tmp_path):
    (name,) = written(tmp_path, [block], SHEETS[width])
    pdf = (tmp_path / f"{name}.pdf").read_bytes()
    assert letters(pdf) == {8.0}
    assert b"/FontFile2" in pdf
    assert size_of(pdf)[0] == pytest.approx(width * POINTS, abs=0.01)
    svg = ElementTree.fromstring((tmp_path / f"{name}.svg").read_text())
    assert float(svg.get("width").removesuffix("pt")) == pytest.approx(width * POINTS, abs=0.01)


@pytest.mark.parametrize(
    "block", [curves("error"), maps("error"), Picture("p", SVG, "")], ids=["curves", "maps", "picture"]
)
def test_the_same_figure_gives_the_same_bytes(block, tmp_path):
    first, second = tmp_path / "1", tmp_path / "2"
    names = [written(folder, [block]) for folder in (first, second)]
    assert names[0] == names[1]
    assert {path.name for path in first.iterdir()} == {path.name for path in second.iterdir()}
    for path in first.iterdir():
        assert path.read_bytes() == (second / path.name).read_bytes()


def test_nothing_is_transparent(tmp_path):
    (name,) = written(tmp_path, [curves("error")])
    assert "opacity" not in (tmp_path / f"{name}.svg").read_text()
    assert set(re.findall(rb"/ca ([\d.]+)", (tmp_path / f"{name}.pdf").read_bytes())) <= {b"1"}


def test_a_drawing_is_made_smaller_and_never_larger(tmp_path):
    wide = SVG.replace('width="40" height="20"', 'width="400pt" height="200pt"').replace("<path", "<g ></g><path")
    small = wide.replace("400pt", "40pt").replace("200pt", "20pt")
    written(tmp_path, [Picture("first wide", wide, ""), Picture("second small", small, "")])
    first, second = (size_of(path.read_bytes()) for path in sorted(tmp_path.glob("*.pdf")))
    assert first == pytest.approx([400.0 * 7.0 / 7.5, 200.0 * 7.0 / 7.5], abs=0.1)  # its text stays at 7 pt
    assert second == pytest.approx([40.0, 20.0], abs=0.1)


def test_any_text_in_any_field_gives_a_plain_name_and_points():
    for text in HOSTILE:
        figures = figures_of(document(text))
        assert len(figures) == 4
        assert [name for name in figures if not re.fullmatch(r"[a-z0-9-]+", name)] == []
        for figure in figures.values():
            as_csv(figure)


@pytest.mark.costs(3)
def test_any_text_in_any_field_is_drawn(tmp_path):
    """A figure of each kind has panels for every text: each is in every field that is drawn."""
    lines = [panel for text in HOSTILE for panel in curves(text).panels]
    cells = [maps(text).panels[0] for text in HOSTILE]
    names = written(tmp_path, [Curves("lines", lines, columns=3), Maps("cells", HOSTILE[0], cells)])
    for name in names:
        ElementTree.fromstring((tmp_path / f"{name}.svg").read_text())
        assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")


def test_one_figure_may_be_asked_for():
    figures = figures_of(report(curves(), curves(origin=Origin("2.1")), maps("Three")))
    assert list(choose_figures(figures, "figure-2-1")) == ["figure-2-1-error-by-error"]
    assert list(choose_figures(figures, "error-by-error")) == ["error-by-error"]
    assert list(choose_figures(figures, None)) == list(figures)
    with pytest.raises(RunnerError, match="no figure 'figure-2-2'") as told:
        choose_figures(figures, "figure-2-2")
    assert all(name in str(told.value) for name in figures)


def test_a_report_without_figures_is_told():
    with pytest.raises(RunnerError, match="the report has no figures"):
        choose_figures(figures_of(report()), None)


def test_panels_stand_below_each_other_in_a_narrow_column(tmp_path):
    x = np.linspace(0.0, 1.0, 5)
    three = Curves("c", [Panel("", "time (s)", "error (m)", [Series("a", x, x)])] * 3, columns=3)
    heights = []
    for width, sheet in SHEETS.items():
        (name,) = written(tmp_path / str(width), [three], sheet)
        heights.append(size_of((tmp_path / str(width) / f"{name}.pdf").read_bytes())[1])
    assert heights[0] > 1.5 * heights[1]


def test_a_drawing_that_would_be_too_small_is_named_with_its_width():
    wide = SVG.replace('width="40" height="20"', 'width="400pt" height="200pt"').replace("<path", "<g ></g><path")
    figures = figures_of(report(Picture("wide", wide, ""), Picture("small", SVG, "")))
    assert list(tell_widths(figures, SHEETS[88.0])) == ["wide is 132 mm wide: in 88 mm its text is below 7 pt"]
    assert list(tell_widths(figures, SHEETS[180.0])) == []


def test_all_files_have_one_version_of_pdf(tmp_path):
    """Fault 11: pdfTeX warns of a figure that is newer than 1.5."""
    written(tmp_path, [curves("error"), Picture("drawing", SVG, ""), playback()])
    assert {path.read_bytes()[:8] for path in tmp_path.glob("*.pdf")} == {b"%PDF-1.4"}


@pytest.mark.costs(4)
@pytest.mark.parametrize("width", [60.0, 88.0, 120.0, 180.0])
def test_the_still_of_a_motion_has_letters_of_7_points_at_any_width(runs, tmp_path, width):
    sheet = column(width)
    written(tmp_path, [still_of(runs["quintic"], "")], sheet)
    made = size_of((tmp_path / "motion.pdf").read_bytes())[0]
    assert made <= width * POINTS + 0.1
    drawn = float(re.search(r'width="([\d.]+)pt"', still_motion(runs["quintic"], width=sheet.width))[1])
    assert 7.5 * min(1.0, made / drawn) >= 7.0
