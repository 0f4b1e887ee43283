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
from tools.option_walk.walk import FAULTS, Step, Verdict, Walk, interpreted, steps_of


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
        steps = [step for own in found.values() for step in own]
        if given.sample:
            steps = random.Random(given.seed).sample(steps, min(given.sample, len(steps)))  # noqa: S311 - no secret
            steps.sort()
        modes = [given.mode] if given.mode else ["compiled", "interpreted"]
        faults = [fault for mode in modes for fault in judge_all(steps, folder, mode, given.verbose)]
    return not faults


def judge_all(steps: list[Step], folder: Path, mode: str, verbose: bool = False) -> list[tuple[Step, Verdict, str]]:
    """Judge changes, print the table of a mode and each fault, and return the faults."""
    began, walker, counts, faults = time.monotonic(), Walk(folder), dict[str, Counter[str]](), []
    with interpreted() if mode == "interpreted" else nullcontext():
        for step in steps:
            verdict, words = walker.judge(step)
            counts.setdefault(step.engine, Counter())[verdict] += 1
            if verdict in FAULTS:
                faults.append((step, verdict, words))
            if verdict in FAULTS or verbose:
                print(f"{verdict:9} {mode}, {step.engine}, {step.scene}: {step.change} {words}", flush=True)
    print(f"{mode}: {len(steps)} changes, {time.monotonic() - began:.0f} s")
    for name, own in counts.items():
        print(f"  {name:20} " + ", ".join(f"{count} {verdict}" for verdict, count in sorted(own.items())))
    return faults
