"""The report on a sweep of stored runs: its parts, and that it is the same each time."""

import shutil

import numpy as np
import pytest
from fixtures.stored import GRID, NOISY

from runner.base.quantities import quantity
from runner.reporting import outline
from runner.reporting.document import Curves, Maps, Playback, RunList, Text
from runner.reporting.mathml import faulty
from runner.reporting.render import write_report
from runner.reporting.sweep.report import sweep_document
from runner.store import open_sweep, write_sweep
from runner.sweeps.job import run

PERIODS, RATES = (0.005, 0.01, 0.02, 0.04), (20, 40, 80)


@pytest.fixture(scope="module")
def document(sweep12, report):
    """The report of the same sweep, whose finer step is simulated by then."""
    assert report.folder.is_dir()
    return sweep_document(sweep12, (), "../../runs/")


@pytest.fixture
def part(sweep12, tmp_path):
    """Copy some cells of the sweep, by their places, into a separate sweep."""

    def copy(*places):
        for place in places:
            name = sweep12.hashes[place]
            shutil.copytree(sweep12.outputs / "runs" / name, tmp_path / "runs" / name)
        return open_sweep(write_sweep(tmp_path, [(GRID[place], sweep12.hashes[place]) for place in places], "..."))

    return copy


def blocks_of(document, kind):
    return [block for block in outline.blocks(document) if isinstance(block, kind)]


def test_the_report_has_all_its_parts(document):
    assert document.title == "What controller.natural_frequency changes, over controller.period"
    assert [section.title for section in document.sections] == [
        "Failed runs",
        "Differences in pairs",
        "Caveats",
        "Axes",
        "Effects of the axes",
        "Compared in pairs",
        "Maps",
        "Trade-off",
        "Distributions",
        "Motions",
        "All runs",
        "Provenance",
    ]
    assert document.shown == 2  # the answer and the failures; all else is folded
    assert faulty(document) == []


@pytest.mark.bullet
def test_the_report_is_as_recorded(document, as_recorded):
    as_recorded("reports", "sweep", document)


def test_the_line_of_theory_parts_the_failed_cells_from_the_others(document):
    cells = blocks_of(document, Maps)[0].panels[0]
    (line,) = cells.lines
    assert line.name == "ω_n h = 1"
    products = [[rate * period for rate in RATES] for period in PERIODS]
    assert cells.failed.tolist() == [[product > 1.0 for product in row] for row in products]


def test_motions_that_differ_only_in_the_question_are_laid_over_each_other(document, sweep12):
    (motion,) = blocks_of(document, Playback)
    names = [run.name for run in (motion, *motion.others)]
    ok = [found for found in sweep12.runs() if found.status == "ok"]
    assert sorted(names) == [f"controller.natural_frequency={rate}" for rate in RATES]
    text = next(block.text for block in blocks_of(document, Text) if "differ only in controller" in block.text)
    assert "The runs differ only in controller.natural_frequency, at controller.period=" in text
    periods = {word for run in (motion, *motion.others) for word in run.origin.command.split() if "period=" in word}
    assert len(periods) == 1
    (curves,) = [block for block in blocks_of(document, Curves) if block.origin == motion.origin]
    assert [series.name for series in curves.panels[0].series] == names
    listing = blocks_of(document, RunList)[0]
    commands = [run.origin.command for run in (motion, *motion.others)]
    assert commands[0] != commands[-1]
    assert listing.hashes[0] in {found.hash for found in ok}


def test_every_run_is_listed_with_its_folder(document, sweep12):
    (listing,) = blocks_of(document, RunList)
    assert sorted(listing.hashes) == sorted(sweep12.hashes)
    assert listing.folders[0] == f"../../runs/{listing.hashes[0]}/"
    assert sum(map(bool, listing.failures)) == sum(found.status == "failed" for found in sweep12.runs()) > 0
    assert all(listing.failures[-1:])  # failed runs come last


def test_a_copied_sweep_links_to_its_own_runs(sweep12, tmp_path):
    copied = tmp_path / "elsewhere"
    shutil.copytree(sweep12.outputs, copied)
    (listing,) = blocks_of(sweep_document(open_sweep(copied / "sweeps" / sweep12.folder.name)), RunList)
    assert all(listing.folders)


def test_the_report_is_the_same_each_time(document, report, tmp_path):
    html, pdf = write_report(document, tmp_path)
    assert html.read_bytes() == (report.folder / "report.html").read_bytes()
    assert pdf.read_bytes() == (report.folder / "report.pdf").read_bytes()
    page = html.read_text()
    assert page.count('<figure class="runlist"') == 1
    assert "figure.runlist" in page


def test_the_first_screen_counts_cells_and_names_no_best(document, sweep12):
    (_, cells, repeated), (_, failed, named), (what, found, of) = document.key_numbers
    assert cells == str(len(sweep12.hashes))
    assert repeated.startswith("repetitions in each: ")
    assert (failed == "0") == (named == "")
    assert what == "largest tracking error"
    assert of.startswith("medians of the cells; worst draw ")
    assert " to " in found
    assert of.split()[-1] == found.split()[-1]  # one unit


def test_the_metric_asked_for_ranks_the_cells(sweep12):
    (listing,) = blocks_of(sweep_document(sweep12, ["peak_torque"]), RunList)
    assert listing.metrics[0] == ("peak_torque", "N m")
    torques = listing.values[:, 0]
    finite = torques[~(torques != torques)]
    assert (finite[1:] >= finite[:-1]).all()


def test_a_sweep_of_one_run_is_reported(part, tmp_path):
    document = sweep_document(part(0))
    assert document.title == "Sweep of one cell"
    assert "One cell: nothing to compare." in document.abstract
    assert write_report(document, tmp_path / "report")


def test_a_sweep_of_failed_runs_is_reported(part, tmp_path):
    document = sweep_document(part(-1, -2))
    assert document.abstract.startswith("2 of 2 cells failed.")
    assert [section.title for section in document.sections] == [
        "Failed runs",
        "Caveats",
        "Axes",
        "All runs",
        "Provenance",
    ]
    assert write_report(document, tmp_path / "report")


def test_a_sweep_over_seeds_is_not_compared_in_pairs(copy_run, tmp_path):
    outputs = tmp_path / "outputs"
    names = [copy_run("pairs").name, run(*NOISY, "seed=1", f"outputs={outputs}").hash]
    jobs = [((f"seed={seed}", *NOISY), name) for seed, name in enumerate(names)]
    sweep = open_sweep(write_sweep(outputs, jobs, "..."))
    document = sweep_document(sweep)
    titles = [section.title for section in document.sections]
    assert "smaller" not in document.abstract
    assert not {"Compared in pairs", "Effects of the axes", "Distributions"} & {*titles}
    assert titles[: document.shown] == ["Distribution over the seeds"]
    drawn = np.sort([value for one in sweep.runs() for value in one.values("max_tracking_error")])
    curve = blocks_of(document, Curves)[0].panels[0].series[0]
    assert curve.x == pytest.approx(np.repeat(drawn, 2))
    assert (curve.y[0], curve.y[-1]) == (0.0, 1.0)
    assert f"Over {len(drawn)} draws the median of the largest tracking error is " in document.abstract
    assert quantity(float(np.median(drawn)), "m") in document.abstract


def test_a_run_without_a_trace_says_how_to_get_one(sweep12, tmp_path):
    copied = tmp_path / "outputs"
    shutil.copytree(sweep12.outputs, copied)
    for trace in copied.glob("runs/*/trace.parquet"):
        trace.unlink()
    document = sweep_document(open_sweep(copied / "sweeps" / sweep12.folder.name))
    assert not blocks_of(document, Playback)
    titles = [getattr(block, "title", "") for block in outline.blocks(document)]
    assert titles.count("No motion to show") == 1
