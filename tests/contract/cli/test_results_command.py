"""`runner results`: the list, the page and the removal of what is old."""

import re
import shutil
from pathlib import Path

import pytest

from runner.reporting.results import Row
from runner.store.listing import ListedResult

TASK = ("robot=macro", "duration=0.05", "noise=thesis", "repetitions=6", "hydra.sweeper.workers=0")


@pytest.fixture
def outputs(cli, tmp_path):
    outputs = tmp_path / "outputs"
    cli("-m", *TASK, f"outputs={outputs}", "trajectory=quintic", "gravity=9.81,9.7")
    cli(*TASK[:-1], f"outputs={outputs}", "trajectory=quintic", "gravity=9.6")
    return outputs


def test_the_list_has_answers_and_does_not_list_runs_of_sweeps(cli, outputs):
    ending = cli("results", outputs)
    assert (ending.code, ending.err) == (0, "")
    head, run, sweep = ending.out.splitlines()
    assert head.split() == ["when", "kind", "what", "answer", "runs", "caveats", "failed", "size", "state", "folder"]
    assert re.match(r"20\d\d-\d\d-\d\d \d\d:\d\d  run ", run)
    assert "largest tracking error" in run
    assert "1 x 6" in run
    assert "  sweep  " in sweep
    assert "largest tracking error: medians from " in sweep  # over a condition only
    assert "2 x 6" in sweep
    assert "good" in sweep


def test_damaged_and_unfinished_results_are_listed(cli, outputs):
    (run,) = (line.split()[-1] for line in cli("results", outputs).out.splitlines() if "  run  " in line)
    record = Path(run) / "metrics.json"
    record.write_text(f"{record.read_text()}x")
    shutil.rmtree(outputs / "sweeps")
    assert "damaged" in next(line for line in cli("results", outputs).out.splitlines() if line.endswith(run))


def test_the_page_is_offline_and_escapes_everything(cli, outputs, tmp_path):
    page = tmp_path / "results.html"
    assert cli("results", outputs, "-o", page).out == f"{page}\n"
    text = page.read_text()
    assert text.count('type="checkbox"') == 2
    assert "default-src 'none'" in text
    assert not re.search(r'(?:src|href)="(?:https?:)?//', text)
    assert text.count("data:image/svg+xml") == 2
    (link,) = re.findall(r'href="([^"]*sweeps[^"]*)"', text)
    assert (page.parent / link).is_dir()
    made = cli("report", next((outputs / "sweeps").iterdir()), "--format", "html").folder
    cli("results", outputs, "-o", page)
    assert f'href="outputs/reports/{made.name}/report.html"' in page.read_text()


def test_deleting_only_lists_without_yes(cli, outputs):
    listed = cli("results", outputs, "--delete", "2100-01-01")
    assert (listed.code, len(listed.out.splitlines())) == (0, 4)  # a sweep, its two runs and a run
    assert "nothing is removed without --yes" in listed.err
    assert cli("results", outputs, "--delete", "1d").out == ""
    assert len(cli("results", outputs).out.splitlines()) == 3
    assert "removed 4 of 4 results" in cli("results", outputs, "--delete", "2100-01-01", "--yes").err
    assert cli("results", outputs).out == f"nothing is stored in {outputs}\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--delete", "yesterday"), "no date or age ('yesterday'). Allowed: a date such as 2026-11-01, or 30d."),
        (("--yes",), "--yes: only with --delete OLDER."),
        (("nowhere",), "nowhere: no such folder. Allowed: an outputs folder."),
    ],
)
def test_bad_arguments_are_refused(cli, words, message):
    ending = cli("results", *words)
    assert (ending.code, ending.out) == (2, "")
    assert message in ending.err


@pytest.mark.parametrize(
    ("size", "shown"), [(0, "0 B"), (999, "999 B"), (1_000, "1 kB"), (12_345_678, "12.3 MB"), (5 * 10**15, "5e+03 TB")]
)
def test_a_size_has_the_largest_unit_of_which_it_has_one(size, shown):
    assert Row(ListedResult("run", Path("a"), 0.0, size, True), "").size == shown
