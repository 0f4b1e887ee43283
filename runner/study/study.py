"""Study: the runs that it needs, its expected results, and its report."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runner.base.errors import RunnerError, nearest
from runner.base.paths import check_inside, ships
from runner.plugins.discovery import use_plugins
from runner.reporting.published_claims import CLAIMS, load_claims
from runner.store import Calibration
from runner.study.code import Code, UserPlugin
from runner.study.expected_caveats import ExpectedCaveat, read_expected
from runner.study.grid import Overrides
from runner.study.grids import FILE as RUNS
from runner.study.grids import Grids
from runner.study.manifest import Profile, read_manifest
from runner.study.names import Location, find_study
from runner.study.results import Parts, Results, Runs, Thing, distinct, name_of
from runner.study.tunings import Gains, Tuning, named, put_in, read_gains

if TYPE_CHECKING:  # drawing comes with these
    from runner.reporting.document import Cover, Document, Section
    from runner.study.chapters import Chapters

Calibrations = Mapping[str, tuple[str, ...]]
"""Overrides of each calibration by its name."""
_PLAN = "plan"  # module whose computed_runs() and calibrations(given) add to runs.yaml
_FEW = 20  # samples that show whether equations can be checked
_MEASURE = "measure"  # module and function that measures what no run does


class Study:
    """A study, read from its folder; docs/paper.md describes the format.

    Args:
        location: Location of its folder.
        allow_code: Whether Python of a folder that is not an installed package may run.
        profile: Name of the profile by which it is made; empty for the one that study.yaml names, or the whole study.
        parts: User-supplied parts in addition to its own.

    Attributes:
        name: What it is called.
        folder: Its folder.
        manifest: Content of study.yaml.
        installed: Whether it is an installed package.
        profile: The profile by which it is made; empty for the whole study.
        expected: The caveats that its runs are to have.
        tuned: The gains that were tuned and not read from its folder.

    Raises:
        RunnerError: with file and place of every problem in its data, or if it does not take a part.
    """

    def __init__(
        self, location: Location, allow_code: bool = False, profile: str = "", parts: Sequence[UserPlugin] = ()
    ) -> None:
        self.name, self.folder = location.name, location.folder
        for path in () if location.package else location.folder.rglob("*"):
            if path.is_symlink():
                check_inside(path, [location.folder])
        self.manifest = read_manifest(location.folder)
        self.installed = location.package is not None
        self.profile = profile or self.manifest.default_profile
        self._profile = self._chosen(self.profile)
        self._code = Code(location.folder, location.package, allow_code)
        self._given = tuple(parts)
        self._gains: Gains = {} if self._profile and self._profile.tuned_anew else read_gains(location.folder)
        self.tuned: Gains = {}
        self._grids = Grids(location.folder / RUNS, self._profile, parts)
        self._check_given()
        self.expected: tuple[ExpectedCaveat, ...] = read_expected(location.folder)
        if (location.folder / CLAIMS).is_file():
            load_claims(location.folder)  # reports problems before anything is simulated
        self._plugins = self._parts()
        if self._plugins and not self._code.runs:
            named = ", ".join(self.manifest.plugins)
            raise RunnerError(f"{self.name}: its runs need {named}: code in a folder runs only with --code")
        if self._plugins:
            use_plugins(self._plugins)

    @property
    def config_dirs(self) -> tuple[Path, ...]:
        """Folders of configs: its own and those of parts that were given."""
        return (*self._own_dirs, *dict.fromkeys(folder for part in self._given for folder in part.config_dirs))

    @property
    def _own_dirs(self) -> tuple[Path, ...]:
        """Its folder, which a command names; the experiments of a built-in study are found without."""
        return () if ships(self.folder / RUNS) and not (self.folder / "robot").is_dir() else (self.folder,)

    def options(self, overrides: Sequence[str]) -> tuple[str, ...]:
        """Return the options of a command that executes one of its runs."""
        folders = (word for folder in self._own_dirs for word in ("--config-dir", os.path.relpath(folder)))
        parts = (text.partition("=") for text in self._plugins)
        named = (word for group, _, file in parts for word in ("--plugin", f"{group}={os.path.relpath(file)}"))
        given = (word for part in self._given if part.override in overrides for word in part.options)
        return (*folders, *named, *given)

    def jobs(self) -> dict[str, Overrides]:
        """Return the overrides of the runs that it needs, by name: of runs.yaml and `plan.py`."""
        more = {name_of(parts): overrides for parts, overrides in self._computed.items()}
        if self._profile is not None:
            more = {name: self._profile.repeated(overrides) for name, overrides in more.items()}
        own = {name: put_in(overrides, self._gains) for name, overrides in self._grids.runs.items()}
        return {**own, **more}

    def parts(self) -> dict[str, Parts]:
        """Return the parts of the name of each run and calibration, also of those that its profile does without."""
        own = {**self._grids.parts, **{name_of(parts): parts for parts in self._computed}}
        return own | self._whole.parts if self.profile else own

    def results(self, found: Mapping[str, Thing], missing: Mapping[str, str] | None = None) -> Results[Thing]:
        """Return stored runs or calibrations by name as results of the study, with why the others were not made."""
        return Results(found, missing, self.dropped(), self.parts())

    def untuned(self) -> list[Tuning]:
        """Return the tunings whose gains its runs take and that are not known, each as many times as they ask for."""
        times: dict[str, int] = {}
        for overrides in self._grids.runs.values():
            for name, number in named(overrides):
                times[name] = max(number, times.get(name, 0))
        return [
            replace(self._grids.tunings[name], times=most) for name, most in times.items() if name not in self._gains
        ]

    def compared(self) -> Iterator[tuple[str, Overrides, Overrides]]:
        """Yield name and overrides of each run with a user-supplied part, and the overrides compared with it.

        See Grids.compared.
        """
        for part in self._given:
            yield from self._grids.compared(part)

    def take(self, gains: Gains) -> None:
        """Add tuned gains to those that are known."""
        self.tuned = gains
        self._gains = {**self._gains, **gains}

    def dropped(self) -> dict[str, str]:
        """Return the runs and calibrations of the whole study that its profile does without, each with why."""
        if not self.profile:
            return {}
        dropped = (name for name in self._whole.parts if name not in self._grids.parts)
        return dict.fromkeys(dropped, f"the profile {self.profile} has no such run")

    @cached_property
    def _whole(self) -> Grids:
        return Grids(self.folder / RUNS)

    def calibrations(self) -> Calibrations:
        """Return the calibrations that it needs, by name, as `plan.py` changes those of runs.yaml."""
        changed: Calibrations = self._planned("calibrations", lambda given: given, self._grids.calibrations)
        return changed

    def chapters(self, runs: Runs, calibrations: Results[Calibration]) -> "Chapters":
        """Return its chapters, made from its stored runs and calibrations by name."""
        from runner.study.chapters import Chapters

        command = self.name if self.installed else os.path.relpath(self.folder)
        return Chapters(self.folder, self.manifest, self._code, self._grids, command, runs, calibrations)

    def check_equations(self) -> None:
        """Check the equations of a study that is not installed, at a few samples.

        Raises:
            RunnerError: with file, line and id of each equation that cannot be checked or typeset.
        """
        if self.installed or not (self.folder / "equations").is_dir():
            return
        from runner.audit.audit import audit
        from runner.audit.sources import Source
        from runner.reporting.audit.report import faulty_formulas

        source = Source(self.folder, self._code.runs)
        if faults := faulty_formulas(source, audit(source, _FEW)):
            raise RunnerError("\n".join(faults))

    def measure(self, outputs: Path) -> None:
        """Measure what no run does, such as computing times, into an outputs folder, where the study does so."""
        function = self._code.functions(_MEASURE).get(_MEASURE)
        if function is not None:
            function(outputs)

    def document(
        self, runs: Runs, calibrations: Results[Calibration], chapters: "Chapters | None" = None
    ) -> "Document":
        """Return its report.

        Args:
            runs: Its stored runs by name.
            calibrations: Its stored calibrations by name.
            chapters: Its chapters, if some have been read.
        """
        from runner.study.report import load_checklist, study_document

        return study_document(
            title=self.manifest.title,
            subtitle=self.manifest.source,
            abstract=self.manifest.abstract,
            chapters=(chapters or self.chapters(runs, calibrations)).sections(),
            runs=runs,
            calibrations=calibrations,
            expected=self.expected,
            checklist=load_checklist(self.folder),
            code=self._code.about(),
            cover=self._cover(runs),
            bibtex=self.manifest.bibtex,
            profile=list(self._by_profile(runs)),
        )

    def _by_profile(self, runs: Runs) -> "Iterator[Section]":
        """Yield what the profile makes otherwise than the whole study; nothing where that is nothing."""
        from runner.reporting.document import Section, Text

        dropped, repetitions = self.dropped(), self._profile.repetitions if self._profile else None
        if not (dropped or repetitions):
            return
        less = " and leaves out some of the whole study" if dropped else ""
        each = f" Every run has {repetitions} repetitions." if repetitions else ""
        text = f"The profile {self.profile} takes {len(distinct(runs)):,} runs{less}.{each}"
        yield Section("Made with a profile", (Text(text),))

    def _cover(self, runs: Runs) -> "Cover | None":
        """Return the picture of the first screen; None where there is none, or its run was not made."""
        from runner.reporting.figures import cover

        wanted = self.manifest.cover
        if wanted is None or wanted.run not in runs or runs[wanted.run].status == "failed":
            return None
        return cover(runs[wanted.run], wanted.caption, wanted.end)

    def _parts(self) -> list[str]:
        """Return its plug-ins, GROUP=FILE each, files by their whole paths."""
        named = [text.partition("=") for text in self.manifest.plugins]
        for _, _, file in named:
            check_inside(self.folder / file, [self.folder])
        return [f"{group}={self.folder / file}" for group, _, file in named]

    def _check_given(self) -> None:
        for part in self._given:
            if part.group not in self._grids.plugins:
                raise RunnerError(
                    f"{self.name}: --plugin {part.override}: none of its runs takes a {part.group} of yours; a grid of "
                    f"{RUNS} that does names the axis, as in plugins: {{law: controller}}"
                )

    @property
    def _computed(self) -> dict[Parts, Overrides]:
        computed: dict[Parts, Overrides] = self._planned("computed_runs", dict)
        return computed

    def _planned(self, name: str, otherwise: Callable[..., Any], *given: Any) -> Any:
        return self._code.functions(_PLAN).get(name, otherwise)(*given)

    def _chosen(self, profile: str) -> Profile | None:
        profiles = self.manifest.profiles
        if profile and profile not in profiles:
            there = f"; profiles: {', '.join(profiles)}" if profiles else "; it has none"
            raise RunnerError(f"{self.name}: no profile '{profile}'{nearest(profile, profiles)}{there}")
        return profiles[profile] if profile else None


def load_study(
    name: str,
    allow_code: bool = False,
    profile: str = "",
    others: Sequence[str] = (),
    parts: Sequence[UserPlugin] = (),
) -> Study:
    """Return a study by its name, or by its folder; see Study and find_study.

    Raises:
        RunnerError: if there is none, or its data do not fit.
    """
    return Study(find_study(name, others), allow_code, profile, parts)
