"""`python -m tools.option_walk`: change one option at a time, and tell which changes have no effect.

A change must alter the hash of the run and the trace or a metric, or be rejected, or be reported by a warning.
The table of scenes says which run feels which key. `made_up_kinds` adds a further kind to each registry.
"""

import argparse
import random
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from tools.option_walk.made_up_kinds import made_up_kinds
from tools.option_walk.scenes import ENGINES, SCENES
from tools.option_walk.walk import FAULTS, Judged, Step, Walk, interpreted, steps_of


def main(arguments: Sequence[str] = ()) -> bool:
    """Walk over all options or a sample; print the table and each fault; return whether there is none."""
    parser = argparse.ArgumentParser(prog="python -m tools.option_walk", description=__doc__)
    parser.add_argument("--scenes", default="", help="names, separated by commas; default: all")
    parser.add_argument("--engines", default="", help="names, separated by commas; default: all")
    parser.add_argument("--mode", choices=("compiled", "interpreted"), help="default: both")
    parser.add_argument("--sample", type=int, help="number of changes, drawn by --seed; default: all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-v", "--verbose", action="store_true", help="print each change")
    given = parser.parse_args(arguments)
    scenes, engines = (
        [name for name in names if not chosen or name in chosen.split(",")]
        for names, chosen in ((SCENES, given.scenes), (ENGINES, given.engines))
    )
    with tempfile.TemporaryDirectory() as temporary, made_up_kinds(Path(temporary)) as folder:
        found = {(name, scene): steps_of(scene, name, folder) for scene in scenes for name in engines}
        for name in engines:
            rejected = [scene for scene in scenes if not found[name, scene]]
            print(f"{name}: {len(scenes) - len(rejected)} scenes; rejected: {', '.join(rejected) or 'none'}")
        lost = [
            scene
            for scene in scenes
            if len(engines) == len(ENGINES) and not any(found[name, scene] for name in engines)
        ]
        print(*(f"no plant accepts the scene {scene}" for scene in lost), sep="\n")
        steps = [step for own in found.values() for step in own]
        if given.sample:
            steps = random.Random(given.seed).sample(steps, min(given.sample, len(steps)))  # noqa: S311 - no secret
            steps.sort()
        modes = [given.mode] if given.mode else ["compiled", "interpreted"]
        judged = [each for mode in modes for each in judge_all(steps, folder, mode, given.verbose)]
    print("\n".join(rows_of(judged)))
    faults = [each for each in judged if each.verdict in FAULTS]
    print(f"{len(faults)} faults" if faults else "nothing untold is left")
    return not faults and not lost


def judge_all(steps: Sequence[Step], folder: Path, mode: str, verbose: bool = False) -> list[Judged]:
    """Judge changes in a mode, and print each fault; verbose prints each change."""
    began, walker, judged = time.monotonic(), Walk(folder), []
    with interpreted() if mode == "interpreted" else nullcontext():
        for step in steps:
            judged.append(Judged(step, *walker.judge(step)))
            if judged[-1].verdict in FAULTS or verbose:
                print(f"{mode}, {judged[-1]}", flush=True)
    print(f"{mode}: {len(steps)} changes, {time.monotonic() - began:.0f} s")
    return judged


def rows_of(judged: Sequence[Judged]) -> list[str]:
    """Return the table of the walk: groups with their kinds, keys and options, plants and verdicts."""
    groups: dict[str, list[Judged]] = {}
    for each in judged:
        groups.setdefault(each.step.key.partition(".")[0], []).append(each)
    rows = [f"{'group':20}  kinds   keys  plants  verdicts"]
    for group, own in sorted(groups.items()):
        kinds, keys, plants = (len({getattr(each.step, name) for each in own}) for name in ("kind", "key", "engine"))
        counts = sorted(Counter(each.verdict for each in own).items())
        verdicts = ", ".join(f"{count} {verdict}" for verdict, count in counts)
        rows.append(f"{group:20}  {kinds:5}  {keys:5}  {plants:6}  {verdicts}")
    return rows
