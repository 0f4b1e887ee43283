import shutil

import pytest

SHORT = ("robot=macro", "duration=0.1")


@pytest.fixture
def stored(cli):
    return cli(*SHORT).folder


def test_a_run_is_reported_as_html_and_pdf(cli, stored):
    ending = cli("report", stored)
    assert ending.code == 0
    assert ending.folder.parent == stored.parent.parent / "reports"
    assert sorted(path.name for path in ending.folder.iterdir()) == ["report.html", "report.pdf"]


@pytest.mark.parametrize(
    ("flags", "files"),
    [(["--html"], ["report.html"]), (["--pdf"], ["report.pdf"]), (["--pdf", "--html"], ["report.html", "report.pdf"])],
)
def test_a_format_can_be_chosen(cli, stored, flags, files):
    ending = cli("report", stored, *flags)
    assert sorted(path.name for path in ending.folder.iterdir()) == files


def test_a_report_can_be_made_from_a_copied_run(cli, stored, tmp_path):
    here = cli("report", stored, "--html").folder.joinpath("report.html").read_bytes()
    copy = tmp_path / "elsewhere" / "runs" / stored.name
    shutil.copytree(stored, copy)
    shutil.rmtree(tmp_path / "outputs")
    ending = cli("report", copy, "--html")
    assert ending.code == 0
    assert ending.folder.joinpath("report.html").read_bytes() == here


def test_a_sweep_is_reported_with_an_overview(cli):
    sweep = cli("-m", *SHORT, "seed=0,1").folder
    ending = cli("report", sweep, "--html")
    page = ending.folder.joinpath("report.html").read_text()
    assert "Overview" in page
    assert "2 runs, all of them finished." in page


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "the following arguments are required: DIR; usage: runner report"),
        (("nowhere",), "no folder nowhere"),
        ((".",), "is no stored run: it has no metrics.json"),
    ],
)
def test_bad_input_is_told(cli, arguments, message):
    ending = cli("report", *arguments)
    assert ending.code == 2
    assert message in ending.err
    assert ending.out == ""
