"""The workflow, hooks before a commit, the citation and release notes are what the Makefile and the sources say."""

import importlib.util
import itertools
import re
import tomllib
from pathlib import Path

import pytest
import yaml

from runner.base.paths import studies_dir

ROOT = Path(__file__).resolve().parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
TARGETS = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.M))


def read(name):
    return yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))


@pytest.fixture
def release_notes():
    spec = importlib.util.spec_from_file_location("release_notes", ROOT / ".ci" / "release_notes.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def commands(job):
    """Yield every command of a job, for each entry of its matrix."""
    matrix = job["strategy"]["matrix"]
    for values in itertools.product(*matrix.values()):
        for step in job["steps"]:
            command = step.get("run", "")
            for key, value in zip(matrix, values, strict=True):
                command = command.replace(f"${{{{ matrix.{key} }}}}", value)
            if "run" in step:
                yield command


def test_every_step_of_the_workflows_is_a_target_of_the_makefile():
    files = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
    given = [each for file in files for job in read(file)["jobs"].values() for each in commands(job)]
    for command in given:
        assert re.fullmatch(r"make [a-z-]+ PYTHON=python3\.\d+", command), command
        assert command.split()[1] in TARGETS, command
    assert {each.split()[1] for each in given} == {
        "lint", "types", "test", "test-pages", "test-lowest", "test-wheel", "docs", "test-slow", "test-busy", "mutants",
    }  # fmt: skip


def test_the_workflow_tests_every_python_that_is_said_to_be_supported():
    tested = read(".github/workflows/ci.yml")["jobs"]["tests"]["strategy"]["matrix"]["python"]
    head = "Programming Language :: Python :: "
    said = [each.removeprefix(head) for each in PROJECT["classifiers"] if each.startswith(head)]
    assert tested == [each for each in said if "." in each]


def test_every_phony_target_is_there():
    phony = re.findall(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(), re.M)
    assert set(" ".join(phony).split()) == TARGETS


def test_hooks_before_a_commit_run_what_is_installed():
    development = {re.split(r"[>=<]", each)[0] for each in PROJECT["optional-dependencies"]["dev"]}
    for repository in read(".pre-commit-config.yaml")["repos"]:
        assert repository["repo"] == "local"  # nothing is fetched
        for hook in repository["hooks"]:
            assert hook["entry"].split()[0].removeprefix(".venv/bin/") in development


def test_every_published_study_and_cited_author_is_in_the_citation():
    citation = read("CITATION.cff")
    assert citation["cff-version"] == "1.2.0"
    assert citation["license"] == PROJECT["license"]
    assert citation["version"] == PROJECT["version"]
    titles = {each["title"] for each in citation["references"]}
    for study in studies_dir().glob("*/study.yaml"):
        bibtex = yaml.safe_load(study.read_text(encoding="utf-8")).get("bibtex", "")
        assert set(re.findall(r"^\s*title = \{(.*)\},$", bibtex, re.M)) <= titles
    for reference in citation["references"]:
        assert {"type", "title", "authors", "year"} <= set(reference)
    families = {person["family-names"] for each in citation["references"] for person in each["authors"]}
    cited = r"\(([A-Z][a-z]+) and ([A-Z][a-z]+)(?:, [A-Z][\w .]+ \d+\(\d+\),| \d{4}\))"
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "runner" / "controllers").rglob("*.py")]
    named = {name for text in sources for pair in re.findall(cited, text) for name in pair}
    assert named
    assert named <= families


def test_release_notes_are_those_of_the_version(release_notes):
    log = (
        "# Changelog\n\n## [Unreleased]\n\n- new\n\n## [0.2.0] - 2026-01-01\n\n- b\n\n## [0.1.0] - 2025-01-01\n\n- a\n"
    )
    assert release_notes.notes(log, "0.2.0") == "- b"
    assert release_notes.notes(log, "0.1.0") == "- a"
    assert release_notes.notes(log, "0.3.0") == "- new"


@pytest.mark.parametrize("log", ["# Changelog\n", "# Changelog\n\n## [Unreleased]\n\n## [0.1.0]\n\n- a\n"])
def test_release_notes_without_a_text_are_refused(release_notes, log):
    with pytest.raises(ValueError, match=r"no section \[0.2.0\] or \[Unreleased\] with a text"):
        release_notes.notes(log, "0.2.0")


def test_this_version_has_release_notes(release_notes, capsys):
    assert release_notes.main() == 0
    assert capsys.readouterr().out.strip()


def test_the_version_stands_in_one_place():
    named = re.compile(rf"(?<![\d.=]){re.escape(PROJECT['version'])}(?![\d.])")
    for name in ("runner", "bench", "tools", ".ci"):
        for path in (ROOT / name).rglob("*.py"):
            assert not named.search(path.read_text(encoding="utf-8")), path
