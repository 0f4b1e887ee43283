"""The digest under which answers to a TAB are kept: it changes with everything that they depend on."""

import pytest

from runner.cli.completion.basis import basis
from runner.symbolic import cache

LINE = ("robot=macro", "plant=rk4", "duration=0.05")


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """Keep answers in a folder of the test's own."""
    (tmp_path / "cache").mkdir()
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")


def test_source_and_what_is_installed_count(tmp_path, monkeypatch):
    package, place = tmp_path / "package", tmp_path / "site"
    package.mkdir()
    place.mkdir()
    monkeypatch.setattr("runner.cli.completion.basis.package_dir", lambda: package)
    monkeypatch.syspath_prepend(str(place))
    digests = {basis(LINE, [])}
    (package / "law.py").write_text("1")
    digests.add(basis(LINE, []))
    (package / "law.py").write_text("2")
    digests.add(basis(LINE, []))
    (place / "engine-1.dist-info").mkdir()
    digests.add(basis(LINE, []))
    assert len(digests) == 4
    assert basis(LINE, []) in digests


def test_the_folder_counts(tmp_path, monkeypatch):
    here = basis(LINE, [])
    monkeypatch.chdir(tmp_path)
    assert basis(LINE, []) != here


def test_a_large_config_folder_is_not_read(tmp_path, monkeypatch):
    (tmp_path / "a.yaml").write_text("a: 1")
    assert basis(LINE, [tmp_path]) is not None
    monkeypatch.setattr("runner.cli.completion.basis._LARGEST", 3)
    assert basis(LINE, [tmp_path]) is None
    monkeypatch.setattr("runner.cli.completion.basis._LARGEST", 100)
    monkeypatch.setattr("runner.cli.completion.basis._MOST", 1)
    assert basis(LINE, [tmp_path]) is None


def test_answers_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "_MOST_ANSWERS", 3)
    for number in range(8):
        cache.write_answer(f"key{number}", number)
    assert cache.read_answer("key7") == 7
    assert len(list((tmp_path / "cache").iterdir())) <= 3
