"""Rank order and leads of the controllers on a second plant."""

import numpy as np
from scipy import stats

from runner.base.quantities import number
from runner.papers.studies.benchmark.cells import BenchmarkCell, cells
from runner.papers.studies.benchmark.made import CONDITIONS
from runner.papers.study.measured import Measured
from runner.papers.study.results import Runs, matching_runs
from runner.reporting.document import Table
from runner.reporting.figures import origin
from runner.reporting.table import numbers
from runner.reporting.words import PLANT, in_words
from runner.store import Run

_ARM = "macro"
_ENGINE = "engine"
_GAINS = ("1",)  # of the first tuning


def engine(runs: Runs) -> str:
    """Return the other engine's name."""
    return PLANT[_first(runs).config["plant"]["kind"]]


def both_orders(runs: Runs, caption: str) -> Table:
    """Return the order of the laws under each condition on both plants, and the rank correlation of their errors."""
    rows = []
    for condition, (here, there) in _both(runs).items():
        orders = [", ".join(in_words(each.law) for each in cell.entries) for cell in (here, there)]
        rows.append([CONDITIONS[condition], *orders, number(_correlation(here, there), 2)])
    header = ["condition", "Runge-Kutta", engine(runs), *numbers("rank correlation")]
    return Table(caption, header, rows, origin(_first(runs)))


def mean_correlation(runs: Runs) -> Measured:
    """Return the mean of the rank correlations over the conditions."""
    told = [_correlation(here, there) for here, there in _both(runs).values()]
    return Measured("mean rank correlation", None if None in told else float(np.mean(np.array(told, dtype=float))))


def against(runs: Runs) -> Measured:
    """Return the number of leads shown on one plant that the other plant shows reversed."""
    turned = 0
    for here, there in _both(runs).values():
        shown = {key for key, lead in there.leads.items() if lead.shown}
        turned += sum(lead.shown and (other, law) in shown for (law, other), lead in here.leads.items())
    return Measured("leads that the other engine turns round", float(turned))


def leads(runs: Runs) -> Measured:
    """Return the number of leads shown on Runge-Kutta."""
    return Measured("leads", float(sum(lead.shown for here, _ in _both(runs).values() for lead in here.leads.values())))


def _both(runs: Runs) -> dict[str, tuple[BenchmarkCell, BenchmarkCell]]:
    """Return each condition on both plants, along the same paths, on the same seeds, with the same gains."""
    seeds = slice(_first(runs).config["repetitions"])
    there = cells(runs, _ARM, _ENGINE, gains=_GAINS)
    tasks = list(
        dict.fromkeys(one.levels["task"] for one in matching_runs(runs, f"{_ENGINE}/{_ARM}/joint_pd/{{task}}/all/1"))
    )
    here = cells(runs, _ARM, seeds=seeds, gains=_GAINS, tasks=tasks)
    return {condition: (here[condition], there[condition]) for condition in CONDITIONS if condition in there}


def _correlation(here: BenchmarkCell, there: BenchmarkCell) -> float | None:
    """Return Spearman's rank correlation of the laws' errors; None where all of them failed on a plant."""
    scores = np.array([[cell.entry(each.law).score for each in here.entries] for cell in (here, there)])
    if any(np.all(own == own[0]) for own in scores):
        return None
    return float(stats.spearmanr(*scores).statistic)


def _first(runs: Runs) -> Run:
    return matching_runs(runs, f"{_ENGINE}/{_ARM}/joint_pd/{{task}}/all/1")[0].run
