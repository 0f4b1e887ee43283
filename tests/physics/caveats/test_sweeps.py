"""Caveats of the cells of a sweep: counted, listed, reported."""

import pandas as pd
import pytest
from support.engines import ASKED

from runner.reporting import outline
from runner.reporting.comparison.runs import runs_document
from runner.reporting.document import Notice, RunList, Table
from runner.reporting.mathml import faulty
from runner.reporting.render import SHOWN
from runner.reporting.run_report import run_document
from runner.reporting.sweep.report import sweep_document
from runner.store import open_run, open_sweep

SWEPT = (
    "-m", "robot=macro", ASKED, "trajectory=quintic", "duration=0.5", "noise.position=0,1e-3",
    "torque_limits.max=1,500",
)  # fmt: skip
HERE = "hydra.sweeper.workers=0"


@pytest.fixture
def swept(cli):
    ending = cli(*SWEPT, HERE)
    assert ending.code == 0
    return ending


def folder_of(ending):
    return ending.out.splitlines()[-1]


def test_cells_with_caveats_are_counted_at_the_end_and_by_status_and_table(swept, cli):
    folder = folder_of(swept)
    assert f"runner: 3 of 4 cells have caveats, 3 at most; `runner table {folder}` says which" in swept.err
    assert "3 of 4 stored cells have caveats" in cli("status", folder).out
    assert "4 cells, 0 of them failed, 3 with caveats" in cli("table", folder).out
    frame = pd.read_parquet(f"{folder}/table.parquet")
    assert frame["caveats"].tolist() == [2, 0, 3, 1]
    assert frame["caveats.rules"].tolist()[1:] == ["", "did_not_follow saturation exact_velocity", "exact_velocity"]


def test_the_report_counts_them_and_shows_the_worst(swept, tmp_path):
    document = sweep_document(open_sweep(tmp_path / folder_of(swept)))
    caveats = next(section for section in document.sections if section.title == "Caveats")
    (table,) = (block for block in caveats.blocks if isinstance(block, Table))
    assert {row[0]: row[1] for row in table.rows} == {
        "exact_velocity": "2 of 4",
        "saturation": "2 of 4",
        "did_not_follow": "2 of 4",
    }
    assert "exact_velocity (2 of 4 cells)" in document.abstract
    (listing,) = (block for block in outline.blocks(document) if isinstance(block, RunList))
    place = list(listing.metrics).index(("caveats", "1"))
    assert place < SHOWN
    assert sorted(listing.values[:, place].tolist()) == [0.0, 1.0, 2.0, 3.0]
    assert not faulty(document)


def test_cells_without_trace_count_too(cli):
    ending = cli(*SWEPT, HERE, "sweep.trace=never")
    assert "3 of 4 cells have caveats" in ending.err
    assert "3 of 4 stored cells have caveats" in cli("status", folder_of(ending)).out
    assert "runner: 3 of 4 cells have caveats" in cli(*SWEPT, HERE, "sweep.trace=never").err


def test_a_sweep_has_one_set_of_thresholds(cli):
    ending = cli("-m", "robot=macro", "caveats.saturation.share=0.1,0.2")
    assert ending.code == 2


def test_a_run_report_begins_with_them(make_run):
    run = make_run("robot=macro", ASKED, "duration=0.1", "noise.position=1e-3")
    first, second, *_ = run_document(run).sections[0].blocks
    assert (first.kind, first.title) == ("warning", "Caveat: did_not_follow")
    assert second.title == "Caveat: exact_velocity"
    assert first.text.startswith("The arm did not follow: at the end the tip is still ")
    both = runs_document([run, make_run("robot=macro", ASKED)])
    assert "May mislead: A: did_not_follow, exact_velocity." in both.abstract


def test_a_report_says_where_thresholds_are_others(make_run):
    run = make_run("robot=macro", ASKED, "duration=0.1", "caveats.did_not_follow.share=5")
    (notice,) = (block for block in outline.blocks(run_document(open_run(run.folder))) if isinstance(block, Notice))
    assert notice.title == "Caveats by other rules than today's"
    assert "caveats.did_not_follow.share 5, now 0.25" in notice.text
