"""Report files: written whole or not at all, in the formats asked for."""

import errno
from types import SimpleNamespace

import pytest
from support.sample_document import curves, document

from runner.base.errors import RunnerError, StoreError
from runner.reporting import render
from runner.reporting.charts import static
from runner.reporting.document import Document, Section
from runner.reporting.render import write_report


def test_both_files_are_written_into_a_new_folder(tmp_path):
    written = write_report(document(), tmp_path / "a" / "b")
    assert [path.name for path in written] == ["report.html", "report.pdf"]
    assert sorted(path.name for path in (tmp_path / "a" / "b").iterdir()) == ["report.html", "report.pdf"]


def test_only_what_is_asked_for_is_written(tmp_path):
    assert write_report(document(), tmp_path, ["pdf"]) == [tmp_path / "report.pdf"]
    assert [path.name for path in tmp_path.iterdir()] == ["report.pdf"]


def test_an_unknown_format_is_named(tmp_path):
    with pytest.raises(RunnerError, match="docx; allowed: html, pdf"):
        write_report(document(), tmp_path / "new", ["docx"])
    assert not (tmp_path / "new").exists()


def test_a_failed_write_leaves_the_old_report(tmp_path, monkeypatch):
    (tmp_path / "report.pdf").write_bytes(b"old")

    def fail(_):
        raise OSError(errno.ENOSPC, "disk full")

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(StoreError, match=r"cannot write .*report.pdf: disk full; free space on its disk"):
        write_report(document(), tmp_path, ["pdf"])
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("report.pdf", b"old")]


def test_the_first_figure_is_drawn_once_for_both_files(tmp_path, monkeypatch):
    drawn = []

    def draw(figure):
        drawn.append(figure)
        return static.draw(figure)

    monkeypatch.setattr(render, "static", SimpleNamespace(draw=draw))
    two = [curves("first"), curves("second")]
    write_report(Document("", "", "", [Section("", two)], ""), tmp_path)
    assert [figure.caption for figure in drawn] == ["first", "second"]
