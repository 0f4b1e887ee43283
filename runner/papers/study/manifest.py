"""Manifest of a study, `study.yaml`: titles, chapters, presets, and profiles of a smaller or larger version."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, TypeVar

from pydantic import Field, PositiveInt

from runner.base.data_file import read_data
from runner.base.errors import RunnerError, nearest
from runner.base.paths import STUDY_FILE
from runner.papers.study.grid import Level, Overrides, StudyGrid
from runner.schema.model import StrictModel

_SUFFIXES = (".md", ".py")

Text = Annotated[str, Field(min_length=1)]


G = TypeVar("G", bound=StudyGrid)


class Profile(StrictModel):
    """Differences of a smaller or larger version from the whole study.

    Attributes:
        repetitions: Repetitions of every run; None leaves those of the grids.
        levels: Levels of axes instead of those in runs.yaml, by grid and axis; an axis with labels takes some of these.
        without: Grids and tunings that it does without.
        tuned_anew: Whether gains are tuned, and not taken from gains.yaml.
    """

    repetitions: PositiveInt | None = None
    levels: dict[str, dict[str, Annotated[list[Level], Field(min_length=1)]]] = Field(default_factory=dict)
    without: list[str] = Field(default_factory=list)
    tuned_anew: bool = False

    def problems(self, grids: Mapping[str, StudyGrid]) -> Iterator[str]:
        """Yield what it names that the grids do not have."""
        for key in dict.fromkeys([*self.levels, *self.without]):
            if key not in grids:
                yield f"there is no grid '{key}'{nearest(key, grids)}"
        for key, axes in self.levels.items():
            if key not in grids:
                continue
            over = grids[key].over
            for axis, levels in axes.items():
                if axis not in over:
                    yield f"grid '{key}': there is no axis '{axis}'{nearest(axis, over)}"
                elif None not in over[axis].values():
                    known = [str(level) for level in over[axis]]
                    for level in map(str, levels):
                        if level not in known:
                            yield f"grid '{key}': axis '{axis}' has no level '{level}'{nearest(level, known)}"

    def applied(self, grids: Mapping[str, G]) -> dict[str, G]:
        """Return the grids that it has, with the levels that it gives their axes."""
        return {key: self._applied(key, grid) for key, grid in grids.items() if key not in self.without}

    def _applied(self, key: str, grid: G) -> G:
        given = self.levels.get(key, {})
        over = {
            axis: {level: levels.get(level) for level in given.get(axis, levels)} for axis, levels in grid.over.items()
        }
        return grid.model_copy(update={"over": over})

    def repeated(self, overrides: Overrides) -> Overrides:
        """Return a run's overrides with the profile's number of repetitions."""
        if self.repetitions is None:
            return overrides
        kept = (text for text in overrides if not text.startswith("repetitions="))
        return (*kept, f"repetitions={self.repetitions}")


class ChapterPart(StrictModel):
    """A chapter whose sections are separate files.

    Attributes:
        title: Its title.
        sections: The files, `.md` or `.py`, in order.
    """

    title: Text
    sections: Annotated[list[Text], Field(min_length=1)]


class CoverRun(StrictModel):
    """Run that is animated on the first screen of the report.

    Attributes:
        run: Name of the run.
        caption: What is seen.
        end: End of the part shown, in s; None shows all.
    """

    run: Text
    caption: Text
    end: Annotated[float, Field(gt=0.0)] | None = None


class Manifest(StrictModel):
    """Content of `study.yaml`.

    Attributes:
        title: Title of the report.
        source: One line below it: author and institution of the source.
        abstract: What comes out; inline mathematics between dollar signs.
        chapters: Files of the chapters in order, `.md` or `.py`, and chapters that have files as sections.
        presets: Names of the presets under which claims are judged, with their words.
        words: Words for levels of axes, for `words=words` in chapters.
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
    chapters: Annotated[list[Text | ChapterPart], Field(min_length=1)]
    presets: dict[str, str] = Field(default_factory=dict)
    words: dict[str, str] = Field(default_factory=dict)
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
    """Return the manifest in a study's folder.

    Raises:
        RunnerError: if `study.yaml` cannot be read or does not fit, or names a missing file.
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
