"""Provenance of a run: the commit is that of this package, or none."""

import shutil
import subprocess

import pytest

from runner.base.paths import package_dir
from runner.simulation import provenance

AUTHOR = ("-c", "user.name=A", "-c", "user.email=a@b.c")


def git(folder, *words):
    return subprocess.run(["git", "-C", folder, *words], capture_output=True, text=True, check=True).stdout.strip()


def commit():
    return provenance.commit.__wrapped__()


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """A folder under git with one file, as commits of another project; git's own variables do not matter."""
    for name in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "notes.txt").write_text("a\n")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", "notes.txt")
    git(tmp_path, *AUTHOR, "commit", "-qm", "Add notes")
    return tmp_path


def installed(monkeypatch, folder):
    """Let a folder be that of the package."""
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("")
    monkeypatch.setattr(provenance, "package_dir", lambda: folder)
    return folder


def test_variables_of_git_name_no_other_commit(repository, monkeypatch):
    own = commit()
    other = git(repository, "rev-parse", "HEAD")
    monkeypatch.setenv("GIT_DIR", str(repository / ".git"))
    monkeypatch.setenv("GIT_WORK_TREE", str(repository))
    assert commit() == own
    assert own is None or other not in own


@pytest.mark.parametrize("place", ["venv/site-packages/runner", "runner"])
def test_a_repository_that_does_not_keep_the_package_is_not_its_own(repository, monkeypatch, place):
    installed(monkeypatch, repository / place)
    assert commit() is None
    (repository / ".gitignore").write_text("venv\nrunner\n")
    assert commit() is None


def test_another_project_that_keeps_a_copy_in_a_folder_below_is_not_its_own(repository, monkeypatch):
    installed(monkeypatch, repository / "third_party" / "runner")
    git(repository, "add", ".")
    git(repository, *AUTHOR, "commit", "-qm", "Add a copy")
    assert commit() is None


def test_a_checkout_has_its_commit_and_tells_of_changes(repository, monkeypatch):
    package = installed(monkeypatch, repository / "runner")
    git(repository, "add", ".")
    git(repository, *AUTHOR, "commit", "-qm", "Add a package")
    head = git(repository, "rev-parse", "HEAD")
    assert commit() == head
    (package / "__init__.py").write_text("a = 1\n")
    assert commit() == f"{head}+changes"
    shutil.rmtree(repository / ".git")
    assert commit() is None


def test_this_checkout_has_a_commit():
    checkout = (package_dir().parent / ".git").exists()
    assert (commit() is not None) == checkout
