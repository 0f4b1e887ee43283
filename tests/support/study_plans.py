"""Runs for tests of the studies' reports: those of the plans, with long runs cut to a moment."""

import re
from collections.abc import Mapping

from support.thin_plans import Overrides, stand_ins

from runner.papers.studies.precision.measure import PLANT
from runner.papers.study.study import load_study

FULL_ALONE = ("late_and_limited.md",)  # chapters only of the benchmark's full profile
MOMENT = 0.08  # s
STUDIES = ("thesis", "thesis_beyond", "xarm7", "meca500", "engines", "benchmark", "precision")
RECORDED = tuple(study for study in STUDIES if study != "meca500")
"""Studies with a recorded thin plan; each session of tests simulates the thin plan of the other study."""
_ENGINES_ARM, _ENGINES_STEP = re.compile(r"^((?:open|reference|closed|least)/)(\w+)"), re.compile(r"^(wall/.*/)[^/]+$")
_ENGINES_ARMS = {"combined": "mini", "macro_mini_mini": "mini", "xarm7_mini": "mini", "xarm7": "macro",
                 "meca500": "macro", "scara": "planar", "seven": "planar"}  # fmt: skip
_ONE_ARM = ("gravity_term", "similarity", "lag", "base_axis", "plants", "sampling", "singular")
_MECA500 = {"step": 0.2, "sine": 0.8, "tip": 0.2, "wall": 0.4, "map": 0.4, "hand": 0.4, "swing": 1.0, "limit": 0.7,
            "noise": 0.3, "inertials": 0.4, "plants": 0.4}  # s, by what the names begin with  # fmt: skip


def cut(overrides: Overrides, duration: float) -> Overrides:
    """Return the overrides of a run aborted."""
    return (*(o for o in overrides if not o.startswith("duration=")), f"duration={duration}")


def thesis_jobs(study: str) -> dict[str, Overrides]:
    """Return all runs of a study of the thesis, with two repetitions, or with one on another plant."""
    return {name: _repeated(job) for name, job in load_study(study).jobs().items()}


def _repeated(overrides: Overrides) -> Overrides:
    kept = (override for override in overrides if not override.startswith("repetitions="))
    return (*kept, f"repetitions={1 if 'plant=rk4' in overrides else 2}")


def thesis_moments(study: str) -> dict[str, Overrides]:
    """Return the same, with the runs of chapter 5 and thesis_beyond cut to a moment, and the Mini's once."""
    moments = {}
    for name, overrides in thesis_jobs(study).items():
        if name.startswith("figure_4"):
            moments[name] = (*(o for o in overrides if not o.startswith("repetitions=")), "repetitions=1")
        elif name.partition("/")[0] in _ONE_ARM or name.startswith("figure_3"):
            moments[name] = overrides
        else:
            moments[name] = cut(overrides, MOMENT)
    return moments


def xarm7_studies() -> dict[str, Overrides]:
    """Return the runs of the studies on the xArm7, without the report's experiments."""
    jobs = load_study("xarm7").jobs()
    return {name: job for name, job in jobs.items() if not job[0].startswith("experiment=")}


def xarm7_moments() -> dict[str, Overrides]:
    """Return the runs of the studies on the xArm7, cut to a moment."""
    return {name: cut(job, MOMENT) for name, job in xarm7_studies().items()}


def meca500_jobs() -> dict[str, Overrides]:
    """Return all runs of the Meca500 report; those of contact, guiding and steps as short as shows what they do."""
    jobs = dict(load_study("meca500").jobs().items())
    lengths = {name: _MECA500.get(name.partition("/")[0]) for name in jobs}
    return {name: o if lengths[name] is None else cut(o, lengths[name]) for name, o in jobs.items()}


def meca500_calibrations() -> dict[str, Overrides]:
    """Return all calibrations of the Meca500 report, with few repetitions."""
    return {
        name: (*(override for override in overrides if override != "repetitions=1"), "repetitions=4")
        for name, overrides in load_study("meca500").calibrations().items()
    }


def engines_stand_ins(jobs: Mapping[str, Overrides]) -> dict[str, str]:
    """Return the substitute for each run of the report on engines: three arms for all, one step for every wall."""
    return {name: _ENGINES_STEP.sub(r"\g<1>0.001", _ENGINES_ARM.sub(_stand_in, name)) for name in jobs}


def _stand_in(found: re.Match[str]) -> str:
    return found[1] + _ENGINES_ARMS.get(found[2], found[2])


def benchmark_kind(name: str) -> str:
    """Return the plan, arm and condition, or change, of a run of the benchmark, from its name."""
    plan, arm, *_, condition, gains = [*name.split("/"), *(["untuned"] if "repeated" in name else [])]
    return f"{plan}/{arm}/{gains if plan == 'changed' else condition}"


def benchmark_kinds() -> dict[str, Overrides]:
    """Return a moment's run of each plan, arm and condition of the benchmark, with one repetition."""
    kinds: dict[str, Overrides] = {}
    for profile in ("", "full"):
        for name, job in load_study("benchmark", profile=profile).jobs().items():
            kept = tuple(o for o in job if not o.startswith("repetitions="))
            kinds.setdefault(benchmark_kind(name), (*cut(kept, 0.01), "repetitions=1"))
    return kinds


def precision_kinds() -> dict[str, Overrides]:
    """Return a moment's run of each case and arm of the report on what precision costs, by these."""
    kinds: dict[str, Overrides] = {}
    for name, job in load_study("precision").jobs().items():
        case, arm, plant, _ = name.split("/")
        if plant == PLANT:
            kinds.setdefault(f"{case}/{arm}", cut(job, 0.016 if case == "free" else 0.02))
    return kinds


def planned(study: str) -> dict[str, Overrides]:
    """Return the runs of a study's plan, by name."""
    return dict(load_study(study).jobs().items())


def stood_in(study: str) -> tuple[dict[str, Overrides], dict[str, str]]:
    """Return the runs of a study's thin plan by name, and the name of the run that stands for each."""
    jobs = planned(study)
    match study:
        case "thesis" | "thesis_beyond":
            return thesis_moments(study), stand_ins(thesis_moments(study))
        case "xarm7":
            studies = xarm7_moments()
            own = {name: name for name in jobs if name not in studies}
            return {**jobs, **studies}, own | stand_ins(studies, every=("payload/",))
        case "engines":
            return jobs, engines_stand_ins(jobs)
        case "meca500":
            jobs = meca500_jobs()
            return jobs, stand_ins(jobs, every=("step/", "plants/", "rest/0"))
    raise ValueError(study)


def recorded_jobs(study: str) -> dict[str, Overrides]:
    """Return the runs of a study that are recorded, by name."""
    if study == "benchmark":
        return benchmark_kinds()
    if study == "precision":
        return precision_kinds()
    jobs, stands_for = stood_in(study)
    return {name: jobs[name] for name in dict.fromkeys(stands_for.values())}


def chapter_files(study: str) -> list[str]:
    """Return the files of a study's chapters."""
    return list(load_study(study).manifest.files())


def chapters_made(study: str) -> list[str]:
    """Return the files of the chapters that are made of the thin plan."""
    return [file for file in chapter_files(study) if file not in FULL_ALONE]
