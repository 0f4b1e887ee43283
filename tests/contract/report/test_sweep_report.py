import shutil

import pytest

from runner.execution import run
from runner.reporting import outline
from runner.reporting.document import Maps, Playback, RunList, Table
from runner.reporting.formulas import faulty
from runner.reporting.render import write_report
from runner.reporting.sweep.report import sweep_document
from runner.store import open_sweep, write_sweep

FIXED = (
    "robot=macro",
    "trajectory=quintic",
    "trajectory.goal=[0.8,0.6,0.7]",
    "trajectory.duration=1.0",
    "duration=1.2",
    "noise=thesis",
    "repetitions=6",
)


def make_sweep(outputs, *cells):
    jobs = [((*cell, *FIXED, f"outputs={outputs}"), run(*cell, *FIXED, f"outputs={outputs}").hash) for cell in cells]
    return open_sweep(write_sweep(outputs, jobs, "runner -m ..."))


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    """Natural frequency times sample time from 0.2 to 3.2; beyond 1 the loop diverges."""
    grid = [(f"controller.natural_frequency={rate}", f"controller.period={period}")
            for rate in (20, 40, 80) for period in (0.01, 0.02, 0.04)]  # fmt: skip
    return make_sweep(tmp_path_factory.mktemp("outputs"), *grid)


@pytest.fixture(scope="module")
def document(sweep):
    return sweep_document(sweep, (), "../../runs/")


def blocks_of(document, kind):
    return [block for block in outline.blocks(document) if isinstance(block, kind)]


def test_the_report_has_all_its_parts(document):
    assert document.title == "Sweep over controller.natural_frequency × controller.period"
    assert [section.title for section in document.sections] == [
        "Caveats",
        "Axes",
        "Which axis matters",
        "Compared in pairs",
        "Maps",
        "Trade-off",
        "Distributions",
        "Best and worst",
        "Failed runs",
        "All runs",
        "Provenance",
    ]
    assert faulty(document) == []


def test_the_line_of_theory_parts_the_failed_cells_from_the_others(document):
    cells = blocks_of(document, Maps)[0].panels[0]
    (line,) = cells.lines
    assert line.name == "ω_n h = 1"
    products = [[rate * period for rate in (20, 40, 80)] for period in (0.01, 0.02, 0.04)]
    assert cells.failed.tolist() == [[product > 1.0 for product in row] for row in products]


def test_best_and_worst_move(document, sweep):
    best, worst = blocks_of(document, Playback)
    assert best.origin.command != worst.origin.command
    listing = blocks_of(document, RunList)[0]
    assert listing.commands[0] == best.origin.command.partition(" outputs=")[0].removesuffix(" plant=mujoco_for_bullet")
    assert listing.hashes[0] in {found.hash for found in sweep.runs() if found.status == "ok"}


def test_the_next_cells_are_compared_in_pairs(document):
    table = next(block for block in blocks_of(document, Table) if "against the best" in block.caption)
    assert table.header[-1] == "than the best"
    assert {row[-1] for row in table.rows} <= {"larger", "no difference shown"}
    assert "larger" in {row[-1] for row in table.rows}


def test_every_run_is_listed_with_its_folder(document, sweep):
    (listing,) = blocks_of(document, RunList)
    assert sorted(listing.hashes) == sorted(sweep.hashes)
    assert listing.folders[0] == f"../../runs/{listing.hashes[0]}/"
    assert sum(map(bool, listing.failures)) == sum(found.status == "failed" for found in sweep.runs()) > 0
    assert all(listing.failures[-1:])  # failed runs come last


def test_a_copy_without_run_folders_gives_no_links(sweep, tmp_path):
    copied = tmp_path / "elsewhere"
    shutil.copytree(sweep.outputs, copied)
    (listing,) = blocks_of(sweep_document(open_sweep(copied / "sweeps" / sweep.folder.name)), RunList)
    assert all(listing.folders)


def test_the_report_is_written_and_the_same_each_time(document, sweep, tmp_path):
    html, pdf = write_report(document, tmp_path / "a")
    again = write_report(sweep_document(sweep, (), "../../runs/"), tmp_path / "b")
    assert [path.read_bytes() for path in again] == [html.read_bytes(), pdf.read_bytes()]
    page = html.read_text()
    assert page.count('<figure class="runlist"') == 1
    assert "figure.runlist" in page


def test_the_first_screen_counts_cells_and_names_the_best(document, sweep):
    (_, cells, repeated), (_, failed, named), (what, _, best) = document.key_numbers
    assert cells == str(len(sweep.hashes))
    assert repeated.startswith("repetitions in each: ")
    assert (failed == "0") == (named == "")
    assert what.startswith("least ")
    assert best in document.abstract.replace("$$", "$")


def test_the_metric_asked_for_ranks_the_cells(sweep):
    (listing,) = blocks_of(sweep_document(sweep, ["peak_torque"]), RunList)
    assert listing.metrics[0] == ("peak_torque", "N m")
    torques = listing.values[:, 0]
    finite = torques[~(torques != torques)]
    assert (finite[1:] >= finite[:-1]).all()


def test_a_sweep_of_one_run_is_reported(tmp_path):
    document = sweep_document(make_sweep(tmp_path, ("seed=0",)))
    assert document.title == "Sweep over nothing"
    assert write_report(document, tmp_path / "report")


def test_a_sweep_of_failed_runs_is_reported(tmp_path):
    cells = [("controller.period=0.04", f"controller.natural_frequency={rate}") for rate in (200, 300)]
    document = sweep_document(make_sweep(tmp_path, *cells))
    assert [section.title for section in document.sections] == [
        "Caveats",
        "Axes",
        "Failed runs",
        "All runs",
        "Provenance",
    ]
    assert write_report(document, tmp_path / "report")


def test_a_sweep_over_seeds_is_not_compared_in_pairs(tmp_path):
    document = sweep_document(make_sweep(tmp_path, ("seed=0",), ("seed=1",)))
    texts = [getattr(block, "text", "") for block in outline.blocks(document)]
    assert any("the sweep varies the seed" in text for text in texts)


def test_a_run_without_a_trace_says_how_to_get_one(sweep, tmp_path):
    copied = tmp_path / "outputs"
    shutil.copytree(sweep.outputs, copied)
    for trace in copied.glob("runs/*/trace.parquet"):
        trace.unlink()
    document = sweep_document(open_sweep(copied / "sweeps" / sweep.folder.name))
    assert not blocks_of(document, Playback)
    titles = [getattr(block, "title", "") for block in outline.blocks(document)]
    assert titles.count("No motion to show") == 2
