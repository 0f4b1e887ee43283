"""A physics server that another run has used gives what a fresh one gives, bit for bit."""

import subprocess
import sys

RUN = """
from runner.config.compose import compose
from runner.config.validation import validate
from runner.assembly import assemble, make_encoders
from runner.simulation import simulate
config = validate(compose(["robot=macro", "noise=thesis", "torque_limits=thesis", "duration=0.5"]).resolved)
loop = assemble(config)
print(simulate(loop, make_encoders(config, loop, 0)).q[-1].tobytes().hex())
"""


def test_a_used_server_gives_what_a_fresh_one_gives(simulated):
    fresh = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, check=True).stdout.strip()
    for other in ("robot=mini", "robot=combined", "robot=macro"):
        simulated(other, "duration=0.1", "gravity=3.7", "plant.step=0.00025")
        trace = simulated("robot=macro", "noise=thesis", "torque_limits=thesis", "duration=0.5")
        assert trace.q[-1].tobytes().hex() == fresh
