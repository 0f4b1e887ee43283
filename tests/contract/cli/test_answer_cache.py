"""The digest under which answers to a TAB are kept: it changes with everything that they depend on."""

import pytest

from runner.base import cache
from runner.cli.completion.overrides import cache_key

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
    monkeypatch.setattr("runner.cli.completion.overrides.package_dir", lambda: package)
    monkeypatch.syspath_prepend(str(place))
    digests = {cache_key(LINE, [])}
    (package / "law.py").write_text("1")
    digests.add(cache_key(LINE, []))
    (package / "law.py").write_text("2")
    digests.add(cache_key(LINE, []))
    (place / "engine-1.dist-info").mkdir()
    digests.add(cache_key(LINE, []))
    assert len(digests) == 4
    assert cache_key(LINE, []) in digests


def test_the_folder_counts(tmp_path, monkeypatch):
    here = cache_key(LINE, [])
    monkeypatch.chdir(tmp_path)
    assert cache_key(LINE, []) != here


def test_nothing_is_kept_for_a_config_folder_with_many_files(tmp_path, monkeypatch):
    key = cache_key(LINE, [tmp_path])
    assert key is not None
    (tmp_path / "a.yaml").write_text("a: 1")
    assert cache_key(LINE, [tmp_path]) not in (key, None)
    monkeypatch.setattr("runner.cli.completion.overrides._MOST", 1)
    assert cache_key(LINE, [tmp_path]) is None


def test_answers_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "_MOST_ANSWERS", 3)
    for number in range(8):
        cache.write_answer(f"key{number}", number)
    assert cache.read_answer("key7") == 7
    assert len(list((tmp_path / "cache").iterdir())) <= 3
