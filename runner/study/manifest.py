"""Manifest of a study, `study.yaml`: titles, chapters, presets and profiles."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from pydantic import Field

from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.base.paths import STUDY_FILE
from runner.schema.model import StrictModel
from runner.study.profiles import Profile

_SUFFIXES = (".md", ".py")

Text = Annotated[str, Field(min_length=1)]


class Part(StrictModel):
    """A chapter whose sections are files of their own.

    Attributes:
        title: Its title.
        sections: The files, `.md` or `.py`, in order.
    """

    title: Text
    sections: Annotated[list[Text], Field(min_length=1)]


class CoverRun(StrictModel):
    """What moves on the first screen of the report.

    Attributes:
        run: Name of the run.
        caption: What is seen.
        end: End of the part shown, in s; None shows all.
    """

    run: Text
    caption: Text
    end: Annotated[float, Field(gt=0.0)] | None = None


class Manifest(StrictModel):
    """All that `study.yaml` says.

    Attributes:
        title: Title of the report.
        source: One line below it: author and institution of the source.
        abstract: What comes out; inline mathematics between dollar signs.
        chapters: Files of the chapters in order, `.md` or `.py`, and chapters that have files as sections.
        presets: Names of the presets under which claims are judged, with their words.
        in_all: Whether `runner reproduce all` makes the study.
        traces: Whether its runs keep their traces, which figures over time read.
        plugins: Parts of the study's own, GROUP=FILE.py each, such as "controller=spring.py".
        profiles: Profiles by name.
        default_profile: Name of the profile by which it is made where none is chosen; empty for the whole study.
        cover: What moves on the first screen.
        bibtex: BibTeX entry of the source.
    """

    title: Text
    source: Text
    abstract: Text
    chapters: Annotated[list[Text | Part], Field(min_length=1)]
    presets: dict[str, str] = Field(default_factory=dict)
    in_all: bool = True
    traces: bool = True
    plugins: list[Text] = Field(default_factory=list)
    profiles: dict[str, Profile] = Field(default_factory=dict)
    default_profile: str = ""
    cover: CoverRun | None = None
    bibtex: str = ""

    def files(self) -> Iterator[str]:
        """Yield the files of all chapters and sections, in order."""
        for chapter in self.chapters:
            yield from (chapter,) if isinstance(chapter, str) else chapter.sections


def read_manifest(folder: Path) -> Manifest:
    """Return what a study's folder says of it.

    Raises:
        RunnerError: if `study.yaml` cannot be read or does not fit, or names a file that is not there.
    """
    path = folder / STUDY_FILE
    manifest = read_data(path, Manifest)
    there = sorted(each.name for each in folder.iterdir() if each.suffix in _SUFFIXES)
    problems = [
        f"chapters: {name}: must be a file of this folder, {' or '.join(_SUFFIXES)}{nearest(name, there)}"
        for name in manifest.files()
        if name not in there
    ]
    if problems:
        raise RunnerError("\n".join(f"{path}: {problem}" for problem in problems))
    return manifest
