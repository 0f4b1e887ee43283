"""Bits of runs under the kernels of other processors, each emulated in another process on this machine.

`python -m tools processors` makes the table of `runs.py` on this processor and under each kernel of `kernels.py`. It
prints each run whose bits differ from those on this processor, and how far rounding grows in it. Two things are judged:
bits on PyBullet and Runge-Kutta between AVX-512 and AVX2, but for `comparison.CAUSES`, and the caveat `rounding_grows`.
"""


def main() -> bool:
    """Compare the kernels; return whether the runs that are judged have the same bits."""
    from tools.processors.comparison import compare  # a process for a kernel needs none of it

    return compare()
