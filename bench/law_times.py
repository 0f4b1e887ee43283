"""Times of control laws in a tick, by themselves and in process: CPU time and wall-clock time, with what is rare.

It has no targets. CPU time shows whether a law's arithmetic fits into its period. Wall-clock time includes other
processes, so it shows the present load of the machine. Both are of laws as a user's Python calls them, through
Pinocchio, without the compiled code of runs.
"""

import os
import platform
import time
from typing import cast

import numpy as np

from runner.assembly.assemble import assemble
from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.controllers import Controller
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_sensors

TICKS = 5000
_LAWS = {
    "Macro": ("robot=macro",),
    "Mini": ("robot=mini",),
    "one-way, Macro and Mini": ("robot=combined",),
    "whole body": ("robot=combined", "controller=whole_body"),
    "three stages": ("robot=macro_mini_mini",),
    "xArm7, computed torque": ("robot=xarm7", "controller=computed_torque"),
}
_QUANTILES = (50.0, 99.0, 99.9, 100.0)


def main() -> bool:
    """Measure and print, without a target."""
    load = ", ".join(f"{value:.2f}" for value in os.getloadavg())
    print(f"time of a control law in a tick, us, of {TICKS} ticks; load average {load}; {platform.platform()}")
    shares = " ".join(f"{name:>7}" for name in ("50 %", "99 %", "99.9 %", "longest"))
    print(f"  {'':26} {'':8} {'':>8}   {'CPU':31}   wall")
    print(f"  {'law':26} {'loop':8} {'period':>8}   {shares}   {shares}")
    for name, overrides in _LAWS.items():
        config = validate(compose([*overrides, "plant=rk4", "trajectory=quintic", "noise=thesis"]))
        closed = assemble(config)
        trace = simulate(closed, *make_sensors(closed, config, 0))
        for loop in closed.loops:
            law = cast(Controller, loop.controller)
            law.reset()
            spent = np.empty((TICKS, 2))
            for tick in range(TICKS):
                row = tick % len(trace.t)
                cpu, wall = time.thread_time_ns(), time.perf_counter_ns()
                law.torque(float(trace.t[row]), trace.q[row], trace.dq[row], trace.desired[row])
                spent[tick] = time.thread_time_ns() - cpu, time.perf_counter_ns() - wall
            cpu_us, wall_us = (np.percentile(own, _QUANTILES) / 1e3 for own in spent.T)
            told = "   ".join(" ".join(f"{value:7.0f}" for value in own) for own in (cpu_us, wall_us))
            print(f"  {name:26} {loop.name:8} {1e6 * loop.period:8.0f}   {told}")
        closed.close()
    return True


if __name__ == "__main__":
    main()
