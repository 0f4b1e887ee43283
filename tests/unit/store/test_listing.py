"""Contents of an outputs folder, and the parts that may be removed."""

import os

import pytest

from runner.base.errors import StoreError
from runner.store.listing import list_entries, removable, remove
from runner.store.sweep import write_sweep

OLD, NEW = 1e9, 2e9


def run_of(outputs, name, written):
    folder = outputs / "runs" / name
    folder.mkdir(parents=True)
    (folder / "metrics.json").write_text("{}")
    (folder / "config.yaml").write_text("abc")
    os.utime(folder / "metrics.json", (written, written))
    return folder


def sweep_of(outputs, names, written):
    folder = write_sweep(outputs, [((f"seed={name}",), name) for name in names], "runner -m")
    os.utime(folder / "sweep.json", (written, written))
    return folder


@pytest.fixture
def outputs(tmp_path):
    """Two old runs, the second in a new sweep, and an old sweep of a third."""
    one, two, three = ("1" * 24, "2" * 24, "3" * 24)
    for name in (one, two, three):
        run_of(tmp_path, name, OLD)
    sweep_of(tmp_path, [two], NEW)
    sweep_of(tmp_path, [three], OLD)
    (tmp_path / "runs" / "notes").mkdir()
    (tmp_path / "baseline.yaml").write_text("schema: 1")
    return tmp_path


def test_the_newest_comes_first_with_kind_and_size(outputs):
    entries = list_entries(outputs)
    assert [entry.kind for entry in entries].count("run") == 3
    assert (entries[0].kind, entries[0].written) == ("sweep", NEW)
    assert {entry.size for entry in entries if entry.kind == "run"} == {5}
    assert all(entry.finished for entry in entries)


def test_runs_of_a_sweep_that_stays_are_kept(outputs):
    found, why = removable(list_entries(outputs), 1.5e9)
    assert why == []
    assert sorted(entry.folder.name[:1] for entry in found if entry.kind == "run") == ["1", "3"]
    assert [entry.kind for entry in found].count("sweep") == 1
    remove(found)
    left = list_entries(outputs)
    assert sorted(entry.kind for entry in left) == ["run", "sweep"]
    assert (outputs / "baseline.yaml").exists()
    assert (outputs / "runs" / "notes").exists()


def test_a_damaged_sweep_that_stays_keeps_all_runs(outputs):
    for folder in (outputs / "sweeps").iterdir():
        (folder / "sweep.json").write_text("{}")
        os.utime(folder / "sweep.json", (NEW, NEW))
    found, why = removable(list_entries(outputs), 1.5e9)
    assert not [entry for entry in found if entry.kind == "run"]
    assert [each.rpartition(". ")[2] for each in why] == ["Its runs are not known, and no run is removed"] * 2


def test_a_link_is_not_followed(outputs, tmp_path_factory):
    elsewhere = run_of(tmp_path_factory.mktemp("elsewhere"), "4" * 24, OLD)
    link = outputs / "runs" / ("4" * 24)
    link.symlink_to(elsewhere)
    found, why = removable(list_entries(outputs), 1.5e9)
    assert why == [f"{link}: it is a link, and nothing that it leads to is removed"]
    assert link not in [entry.folder for entry in found]
    with pytest.raises(StoreError, match=r"cannot remove \S+: Cannot call rmtree on a symbolic link"):
        remove([entry for entry in list_entries(outputs) if entry.folder == link])
    assert (elsewhere / "config.yaml").exists()


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(StoreError, match="gone: no such folder"):
        list_entries(tmp_path / "gone")
