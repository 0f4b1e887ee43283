"""What the chapters call: tables and maps over arms, laws and conditions, and the numbers of the findings."""

from collections.abc import Mapping

import numpy as np

from runner.drawing.figure import Map
from runner.quantities import number, quantity
from runner.reporting.document import Maps, Origin, Table
from runner.reporting.figures import origin
from runner.reporting.measured import Measured
from runner.reporting.prose.patterns import found
from runner.reporting.words import in_words
from runner.store import Run
from runner.works.benchmark.cells import Cell, Entry, Lead, cells, errors_of

ARMS = {"macro": "Macro", "planar": "planar arm", "xarm7": "xArm7"}
CONDITIONS = {
    "exact": "nothing is wrong",
    "masses": "wrong masses",
    "friction": "unknown friction",
    "encoders": "encoder noise",
    "all": "all three at once",
}
_JOINTS = "of the joints"
_KNOWS = {
    "operational_space": ("M, V and G", "Cartesian, in 3 directions", "no"),
    "computed_torque": ("M, V and G", _JOINTS, "no"),
    "joint_pd": ("G, diag M at home", _JOINTS, "no"),
    "joint_pid": ("G, diag M at home", f"{_JOINTS}, with an integral", "no"),
    "passivity": ("M, V and G, diag M at home", _JOINTS, "no"),
    "sliding_mode": ("M, V and G, diag M at home", _JOINTS, "no"),
    "adaptive": ("M, V and G, diag M at home, to begin with", _JOINTS, "finds it"),
    "observed": ("M, V and G", f"{_JOINTS}, with an observer", "finds it"),
    "observed_pd": ("M, V and G", f"{_JOINTS}, with an observer", "finds it"),
}
_UNKNOWN = "not told"
_FAR = 1.1  # ratio of errors that three digits tell from one


def best_laws(runs: Mapping[str, Run], arm: str, caption: str) -> Table:
    """Return the law with the smallest error under each condition, and how far the next one is behind it."""
    header = ["condition", "smallest error", "its error", "next", "error of the next", "ahead of"]
    rows = []
    for condition, cell in _cells(runs, arm).items():
        best, second = cell.entries[0], cell.entries[1]
        rows.append(
            [
                CONDITIONS[condition],
                in_words(best.law),
                _error(best),
                in_words(second.law),
                _behind(cell.leads[best.law, second.law]),
                _ahead_of(cell),
            ]
        )
    return Table(caption, header, rows, (2,), _origin(runs, arm))


def errors(runs: Mapping[str, Run], arm: str, caption: str) -> Table:
    """Return the error of every law under every condition, in the order of the plan."""
    made = _cells(runs, arm)
    rows = [[in_words(law), *(_error(cell.entry(law)) for cell in made.values())] for law in _laws(runs, arm)]
    return Table(
        caption, ["law", *(CONDITIONS[name] for name in made)], rows, range(1, 1 + len(made)), _origin(runs, arm)
    )


def behind_the_best(runs: Mapping[str, Run], caption: str) -> Maps:
    """Return the error of every law over that of the best one as maps, an arm each; runs that failed are marked."""
    panels = []
    for arm, title in ARMS.items():
        made, laws = _cells(runs, arm), _laws(runs, arm)[::-1]
        ratios = np.array([[_ratio(cell.entry(law), cell.best) for cell in made.values()] for law in laws], dtype=float)
        failed = np.array([[cell.entry(law).failed > 0.0 for cell in made.values()] for law in laws])
        hints = [f"{number(float(ratio))} times the smallest error" for ratio in ratios.flat]
        names = [CONDITIONS[name] for name in made]
        values = np.where(np.isfinite(ratios), ratios, np.nan)
        panels.append(Map(title, "", "", names, [in_words(law) for law in laws], values, failed, hints=hints))
    return Maps(caption, "error over the smallest", panels, True, 1, _origin(runs, "macro"))


def ranks(runs: Mapping[str, Run], caption: str) -> Table:
    """Return the mean rank of every law over the conditions of each arm, and over all arms."""
    by_arm = {arm: [[each.law for each in cell.entries] for cell in _cells(runs, arm).values()] for arm in ARMS}
    rows = []
    for law in _laws(runs, "macro"):
        places = {arm: [order.index(law) + 1 for order in orders] for arm, orders in by_arm.items()}
        means = [
            float(np.mean(each)) for each in (*places.values(), [place for own in places.values() for place in own])
        ]
        rows.append([in_words(law), *(number(mean, 2, zeros=True) for mean in means)])
    return Table(caption, ["law", *ARMS.values(), "all"], rows, range(1, 2 + len(ARMS)), _origin(runs, "macro"))


def knowledge(runs: Mapping[str, Run], caption: str) -> Table:
    """Return what each law is told beside the joints' positions and velocities, and its bandwidth on each arm."""
    rows = []
    for law in _laws(runs, "macro"):
        model, loop, friction = _KNOWS.get(law, (_UNKNOWN, _UNKNOWN, _UNKNOWN))
        others = ["no" if law in _KNOWS else _UNKNOWN] * 2
        rows.append(
            [in_words(law), model, loop, friction, *others, ", ".join(_bandwidth(runs, arm, law) for arm in ARMS)]
        )
    header = ["law", "model", "loop", "friction", "torque sensor", "that a motion repeats", "bandwidths (rad/s)"]
    return Table(caption, header, rows, (), _origin(runs, "macro"))


def settings(runs: Mapping[str, Run], caption: str) -> Table:
    """Return what is the same for all laws of an arm, and what the conditions do to it."""
    header = ["arm", "bandwidth", "period", "masses wrong by up to", "friction", "viscous friction", "encoder noise"]
    rows = []
    for arm, title in ARMS.items():
        config = found(runs, f"laws/{arm}/joint_pd/{{task}}/all")[0].run.config
        friction = config["plant"]["friction"]
        rows.append(
            [
                title,
                quantity(config["controller"]["natural_frequency"], "rad/s"),
                quantity(config["controller"]["period"], "s"),
                quantity(100.0 * config["mismatch"]["spread"], "%"),
                f"{_listed(friction['coulomb'])} N m",
                f"{_listed(friction['viscous'])} N m s/rad",
                quantity(float(np.max(config["noise"]["position"])), "rad"),
            ]
        )
    return Table(caption, header, rows, range(1, 7), _origin(runs, "macro"))


def times(runs: Mapping[str, Run], condition: str, law: str, other: str, *arms: str) -> list[Measured]:
    """Return the error of a law over that of another one on some arms, of all where none is named."""
    found_on = {arm: _cells(runs, arm)[condition] for arm in arms or ARMS}
    return [
        Measured(
            f"error of {in_words(law)} over that of {in_words(other)}, {ARMS[arm]}, {CONDITIONS[condition]}",
            _ratio(cell.entry(law), cell.entry(other)),
        )
        for arm, cell in found_on.items()
    ]


def sure_times(runs: Mapping[str, Run], condition: str, law: str, other: str, *arms: str) -> list[Measured]:
    """Return the lower end of the interval of how far a law is behind another one; below 1 where it is ahead."""
    told = []
    for arm in arms or ARMS:
        lead = _cells(runs, arm)[condition].leads.get((other, law))
        low = None if lead is None or lead.interval is None else lead.interval[0]
        words = f"{in_words(law)} over {in_words(other)}, {ARMS[arm]}, {CONDITIONS[condition]}"
        told.append(Measured(f"lower end of the error of {words}", low))
    return told


def sure_leads(runs: Mapping[str, Run], condition: str, law: str, *others: str) -> list[Measured]:
    """Return the lower ends of the intervals of how far some laws are behind one, on all arms."""
    return [told for other in others for told in sure_times(runs, condition, other, law)]


def failed_repetitions(runs: Mapping[str, Run], law: str, *arms: str) -> Measured:
    """Return how many repetitions of a law failed on some arms, of all where none is named."""
    own = [one.run for arm in arms or ARMS for one in found(runs, f"laws/{arm}/{law}/{{task}}/{{condition}}")]
    failed = sum(int(np.isinf(errors_of(run)).sum()) for run in own)
    on = " and ".join(ARMS[arm] for arm in arms) or "all arms"
    return Measured(f"repetitions of {in_words(law)} that failed, {on}", float(failed))


def said_again(runs: Mapping[str, Run]) -> Measured:
    """Return of the leads that one half of the seeds shows the share that the other half shows, too, in per cent."""
    said, again, _ = _halves(runs)
    return Measured("leads that the other half of the seeds shows, too", 100.0 * again / said if said else None, "%")


def said_otherwise(runs: Mapping[str, Run]) -> Measured:
    """Return how many leads of one half of the seeds the other half shows the other way round."""
    return Measured("leads that the other half of the seeds turns round", float(_halves(runs)[2]))


def family(runs: Mapping[str, Run], arm: str) -> Measured:
    """Return how many comparisons of an arm are corrected together."""
    tested = [lead for cell in _cells(runs, arm).values() for lead in cell.leads.values() if lead.p_value is not None]
    return Measured(f"comparisons on the {ARMS[arm]}", float(len(tested)))


def _halves(runs: Mapping[str, Run]) -> tuple[int, int, int]:
    """Return how many drawn leads each half of the seeds shows, and of these the other one, too, or turned round."""
    shown = []
    for half in (slice(0, None, 2), slice(1, None, 2)):
        made = [(arm, name, cell) for arm in ARMS for name, cell in cells(runs, arm, seeds=half).items()]
        drawn = [(arm, name, key) for arm, name, cell in made for key, lead in cell.leads.items()
                 if lead.shown and lead.p_value is not None]  # fmt: skip
        shown.append(set(drawn))
    a, b = shown
    turned = {(arm, name, (other, law)) for arm, name, (law, other) in a}
    return len(a) + len(b), 2 * len(a & b), 2 * len(turned & b)


def _cells(runs: Mapping[str, Run], arm: str) -> dict[str, Cell]:
    made = cells(runs, arm)
    return {condition: made[condition] for condition in CONDITIONS}


def _bandwidth(runs: Mapping[str, Run], arm: str, law: str) -> str:
    config = found(runs, f"laws/{arm}/{law}/{{task}}/exact")[0].run.config
    return number(config["controller"].get("natural_frequency"))


def _laws(runs: Mapping[str, Run], arm: str) -> list[str]:
    return list(dict.fromkeys(one.levels["law"] for one in found(runs, f"laws/{arm}/{{law}}/{{task}}/exact")))


def _error(entry: Entry) -> str:
    if entry.failed == 0.0:
        return quantity(entry.score, "m")
    failed = f"{number(100.0 * entry.failed, 2)} % failed"
    return f"{quantity(entry.score, 'm')}, {failed}" if np.isfinite(entry.score) else failed


def _behind(lead: Lead) -> str:
    digits = 3 if lead.factor > _FAR else 4
    factor, *ends = (number(value, digits, zeros=True) for value in (lead.factor, *(lead.interval or ())))
    return f"{factor} times ({' to '.join(ends)})" if ends else f"{factor} times"


def _ahead_of(cell: Cell) -> str:
    tied = cell.tied
    if not tied:
        return "all"
    rest = [in_words(each.law) for each in cell.entries[1:] if each.law not in tied]
    return ", ".join(rest) or "none"


def _ratio(one: Entry, other: Entry) -> float | None:
    return one.score / other.score if np.isfinite(other.score) else None


def _listed(value: object) -> str:
    values = np.atleast_1d(np.asarray(value, dtype=float))
    low, high = number(float(values.min())), number(float(values.max()))
    return low if low == high else f"{low} to {high}"


def _origin(runs: Mapping[str, Run], arm: str) -> Origin:
    return origin(found(runs, f"laws/{arm}/joint_pd/{{task}}/all")[0].run)
