"""Study: the runs that it needs, its expected results, and its report."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from runner.base.errors import RunnerError, nearest
from runner.base.paths import check_inside, ships
from runner.papers.reporting.published_claims import CLAIMS, load_claims
from runner.papers.study.code import StudyCode, UserPlugin
from runner.papers.study.expected_caveats import ExpectedCaveat, read_expected
from runner.papers.study.grid import Overrides
from runner.papers.study.grids import FILE as RUNS
from runner.papers.study.grids import Grids
from runner.papers.study.manifest import Profile, read_manifest
from runner.papers.study.names import Location, find_study
from runner.papers.study.results import Parts, Results, Thing, name_of
from runner.papers.study.tunings import Gains, StudyTuning, named, put_in, read_gains
from runner.plugins.discovery import use_plugins

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
        chosen: What this profile changes; None for the whole study.
        code: Its Python.
        grids: Its runs.yaml.
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
        self.chosen = self._profile(self.profile)
        self.code = StudyCode(location.folder, location.package, allow_code)
        self._given = tuple(parts)
        self._gains: Gains = {} if self.chosen and self.chosen.tuned_anew else read_gains(location.folder)
        self.tuned: Gains = {}
        self.grids = Grids(location.folder / RUNS, self.chosen, parts)
        self._check_given()
        self.expected: tuple[ExpectedCaveat, ...] = read_expected(location.folder)
        if (location.folder / CLAIMS).is_file():
            load_claims(location.folder)  # reports problems before anything is simulated
        self._plugins = self._parts()
        if self._plugins and not self.code.runs:
            named = ", ".join(self.manifest.plugins)
            raise RunnerError(f"{self.name}: its runs need {named}: code in a folder runs only with --code")
        if self._plugins:
            use_plugins(self._plugins)

    @property
    def command(self) -> str:
        """What `runner reproduce` takes for it: its name or its folder."""
        return self.name if self.installed else os.path.relpath(self.folder)

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
        if self.chosen is not None:
            more = {name: self.chosen.repeated(overrides) for name, overrides in more.items()}
        own = {name: put_in(overrides, self._gains) for name, overrides in self.grids.runs.items()}
        return {**own, **more}

    def parts(self) -> dict[str, Parts]:
        """Return the parts of the name of each run and calibration, also of those that its profile does without."""
        own = {**self.grids.parts, **{name_of(parts): parts for parts in self._computed}}
        return own | self._whole.parts if self.profile else own

    def results(self, found: Mapping[str, Thing], missing: Mapping[str, str] | None = None) -> Results[Thing]:
        """Return stored runs or calibrations by name as results of the study, with why the others were not made."""
        return Results(found, missing, self.dropped(), self.parts())

    def untuned(self) -> list[StudyTuning]:
        """Return the tunings whose gains its runs take and that are not known, each as many times as they ask for."""
        times: dict[str, int] = {}
        for overrides in self.grids.runs.values():
            for name, number in named(overrides):
                times[name] = max(number, times.get(name, 0))
        return [
            replace(self.grids.tunings[name], times=most) for name, most in times.items() if name not in self._gains
        ]

    def compared(self) -> Iterator[tuple[str, Overrides, Overrides]]:
        """Yield name and overrides of each run with a user-supplied part, and the overrides compared with it.

        See Grids.compared.
        """
        for part in self._given:
            yield from self.grids.compared(part)

    def take(self, gains: Gains) -> None:
        """Add tuned gains to those that are known."""
        self.tuned = gains
        self._gains = {**self._gains, **gains}

    def dropped(self) -> dict[str, str]:
        """Return the runs and calibrations of the whole study that its profile does without, each with why."""
        if not self.profile:
            return {}
        dropped = (name for name in self._whole.parts if name not in self.grids.parts)
        return dict.fromkeys(dropped, f"the profile {self.profile} has no such run")

    @cached_property
    def _whole(self) -> Grids:
        return Grids(self.folder / RUNS)

    def calibrations(self) -> Calibrations:
        """Return the calibrations that it needs, by name, as `plan.py` changes those of runs.yaml."""
        changed: Calibrations = self._planned("calibrations", lambda given: given, self.grids.calibrations)
        return changed

    def check_equations(self) -> None:
        """Check the equations of a study that is not installed, at a few samples.

        Raises:
            RunnerError: with file, line and id of each equation that cannot be checked or typeset.
        """
        if self.installed or not (self.folder / "equations").is_dir():
            return
        from runner.papers.audit.audit import audit
        from runner.papers.audit.sources import Source
        from runner.papers.reporting.audit_report import faulty_formulas

        source = Source(self.folder, self.code.runs)
        if faults := faulty_formulas(source, audit(source, _FEW)):
            raise RunnerError("\n".join(faults))

    def measure(self, outputs: Path) -> None:
        """Measure what no run does, such as computing times, into an outputs folder, where the study does so."""
        function = self.code.functions(_MEASURE).get(_MEASURE)
        if function is not None:
            function(outputs)

    def _parts(self) -> list[str]:
        """Return its plug-ins, GROUP=FILE each, files by their whole paths."""
        named = [text.partition("=") for text in self.manifest.plugins]
        for _, _, file in named:
            check_inside(self.folder / file, [self.folder])
        return [f"{group}={self.folder / file}" for group, _, file in named]

    def _check_given(self) -> None:
        for part in self._given:
            if part.group not in self.grids.plugins:
                raise RunnerError(
                    f"{self.name}: --plugin {part.override}: none of its runs takes a {part.group} of yours; a grid of "
                    f"{RUNS} that does names the axis, as in plugins: {{law: controller}}"
                )

    @property
    def _computed(self) -> dict[Parts, Overrides]:
        computed: dict[Parts, Overrides] = self._planned("computed_runs", dict)
        return computed

    def _planned(self, name: str, otherwise: Callable[..., Any], *given: Any) -> Any:
        return self.code.functions(_PLAN).get(name, otherwise)(*given)

    def _profile(self, profile: str) -> Profile | None:
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
