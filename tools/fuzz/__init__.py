"""`python -m tools.fuzz [configs|stores] [--cases N] [--seed S] [--lines N]`: bad input and damage of every kind.

Nothing may end in a traceback or a crash, take 5 s of CPU time or 500 MB over a sound case, or answer with more than
10 kB or with control characters. The seed and its number determine a case: `--only N` tries and shows only this one.
"""

import argparse
import multiprocessing
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tools.fuzz import configs, lines, stores

_BATCH = 500  # cases in a process, so that a crash ends no more than that


def try_configs(options: argparse.Namespace) -> bool:
    """Fuzz configs in process, then command lines; print what was found, and return whether that is nothing."""
    if options.only is not None:
        given = configs.case(options.seed, options.only)
        print(given)
        with tempfile.TemporaryDirectory() as name:
            print(configs.attempt(given, Path(name)))
        return True
    ended = dict(_in_processes(options.seed, options.cases))
    judged = {number: end.faults + configs.judge_costs(end) for number, end in ended.items()}
    bad = {number: faults for number, faults in judged.items() if faults}
    refused = sum(end.refused for end in ended.values())
    slowest = max((end.seconds for end in ended.values()), default=0.0)
    print(
        f"{len(ended)} configs, seed {options.seed}: {refused} refused, {len(bad)} with faults; slowest {slowest:.2f} s"
    )
    _show(bad)
    sound = _lines(options.seed, options.lines) if options.lines else True
    return sound and not bad


def damage_stores(options: argparse.Namespace) -> bool:
    """Damage a store of every kind of file; print what was found, and return whether that is nothing."""
    with tempfile.TemporaryDirectory() as name:
        outputs = Path(name, "outputs")
        stores.make_store(outputs)
        ways = {
            "flipped bits": stores.flip_bits(outputs, options.cases, options.seed),
            "other damages": stores.damage_files(outputs, options.cases, options.seed),
            "damages met by commands": stores.damage_files(outputs, options.cases // 20, options.seed, True),
        }
        found = {way: list(faults) for way, faults in ways.items()}
    for way, faults in found.items():
        print(f"{way}, {options.cases} of the store's files, seed {options.seed}: {len(faults)} with faults")
        print("\n".join(f"  {fault}" for fault in faults[:20]))
    return not any(found.values())


def _lines(seed: int, count: int) -> bool:
    usual = lines.plain()
    bad, codes, slowest, largest = {}, [], 0.0, 0.0
    for number in range(count):
        with tempfile.TemporaryDirectory() as name:
            words = lines.line(seed, number, Path(name))
            measured = lines.measure(words, Path(name))
        faults = lines.judge(measured, usual)
        if faults:
            bad[number] = [*faults, f"{words!r:.300}"]
        codes.append(measured.code)
        slowest, largest = max(slowest, measured.seconds), max(largest, measured.megabytes)
    counts = ", ".join(f"{codes.count(code)} with {code}" for code in sorted(set(codes), key=str))
    print(f"{count} command lines, seed {seed}: {counts}; {len(bad)} with faults")
    print(f"  plain: {usual.seconds:.1f} s, {usual.megabytes:.0f} MB; most: {slowest:.1f} s, {largest:.0f} MB")
    _show(bad)
    return not bad


def _show(bad: dict[int, list[str]]) -> None:
    for number, faults in bad.items():
        print(f"  {number}: {'; '.join(faults)}")


def _in_processes(seed: int, count: int) -> Iterator[tuple[int, configs.Ended]]:
    """Yield how each case ended; the one that brings its process down ends as a fault, and the next continues."""
    start = 0
    while start < count:
        receive, send = multiprocessing.Pipe(duplex=False)
        worker = multiprocessing.get_context("fork").Process(
            target=_work, args=(send, seed, range(start, min(start + _BATCH, count)))
        )
        worker.start()
        send.close()
        while True:
            try:
                number, ended = receive.recv()
            except EOFError:
                break
            yield number, ended
            start = number + 1
        worker.join()
        if worker.exitcode:
            yield start, configs.Ended(False, [f"crash: exit code {worker.exitcode}"])
            start += 1


def _work(send: Any, seed: int, numbers: range) -> None:
    with tempfile.TemporaryDirectory() as name:
        for number in numbers:
            send.send((number, configs.attempt(configs.case(seed, number), Path(name))))


TARGETS: dict[str, Callable[[argparse.Namespace], bool]] = {"configs": try_configs, "stores": damage_stores}
"""Kinds of fuzzing."""


def main(arguments: list[str] | None = None) -> bool:
    """Fuzz what the arguments name, all of it a little where there are none; return whether nothing was found."""
    parser = argparse.ArgumentParser(prog="python -m tools.fuzz", description=__doc__)
    parser.add_argument("targets", nargs="*", choices=[*TARGETS, []], help="default: all")
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--lines", type=int, default=20, help="command lines, each in a separate process")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, metavar="N", help="try and show only case N")
    options = parser.parse_args(arguments or [])
    met = [TARGETS[name](options) for name in options.targets or TARGETS]
    return all(met)
