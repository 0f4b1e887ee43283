"""CPU time until a torque law is machine code: nothing kept (cold), and kept by an earlier process (warm)."""

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from bench.arms import ARMS, Arm, assembled
from runner.assembly.assemble import assemble_program
from runner.symbolic import program


def main() -> bool:
    """Measure and print; return whether every target is met."""
    print("CPU time to compile a law, in s: nothing kept, and kept by an earlier process")
    met = [_judge(arm, law) for arm in ARMS for law in arm.laws]
    return all(met)


def _judge(arm: Arm, law: str) -> bool:
    found = assemble_program(assembled(arm, law, "rk4", 1, 1)[0])
    if found is None:
        print(f"  {arm.name}, {law}: not compiled  MISSED")
        return False
    loop_program = found[0]
    works: dict[str, Callable[[], object]] = {
        "law only": loop_program.commands.program,
        "tick on rk4": lambda: loop_program.program(1),
        "tick of a batch": lambda: loop_program.program(program.LANES),
    }
    met = []
    for what, work in works.items():
        with _empty_cache():
            cold, warm = _cpu_time(work), _cpu_time(work)
        met.append(cold <= arm.compiles)
        verdict = "met" if met[-1] else "MISSED"
        name = f"{arm.name}, {law}, {what}"
        print(f"  {name:46} {cold:6.2f}  {warm:6.3f}  target {arm.compiles:g}: {verdict}")
    return all(met)


def _cpu_time(work: Callable[[], object]) -> float:
    program._program.cache_clear()
    start = time.process_time()
    work()
    return time.process_time() - start


@contextmanager
def _empty_cache() -> Iterator[None]:
    before = os.environ.get("XDG_CACHE_HOME")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        try:
            yield
        finally:
            os.environ.pop("XDG_CACHE_HOME")
            if before is not None:
                os.environ["XDG_CACHE_HOME"] = before
