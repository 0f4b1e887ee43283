"""Short runs under the kernels of other processors, each in another process, against this process, bit by bit."""

import pytest

from runner.base.engines import has_pybullet
from tools.processors.bits import make, make_under
from tools.processors.kernels import KERNELS, not_emulated

OF_BULLET = {
    "bullet": ("robot=macro", "trajectory=quintic", "input_shaper=zvd", "input_shaper.frequency=20"),
    "bullet, wall": ("robot=macro", "controller=impedance", "environment=wall", "environment.distance=0"),
}
OF_RUNGE_KUTTA = {
    "noise": ("robot=macro", "noise=thesis", "mismatch=sampled", "repetitions=2", "torque_limits=thesis"),
    "friction": ("robot=panda", "plant.friction.coulomb=0.5", "plant.friction.sigmoid.level=0.5",
                 "plant.friction.sigmoid.steepness=5", "plant.friction.sigmoid.shift=0.03"),
    "two stages": ("robot=combined", "trajectory=quintic", "disturbance_observer=momentum"),
    "sinusoids": ("robot=planar", "controller=computed_torque", "trajectory=joint_sinusoids"),
}  # fmt: skip
RUNS = {
    **{name: [*words, "plant=rk4", "duration=0.1"] for name, words in OF_RUNGE_KUTTA.items()},
    **({name: [*words, "plant=bullet", "duration=0.1"] for name, words in OF_BULLET.items()} if has_pybullet() else {}),
}
WITH_AVX2 = ("skylakex", "haswell")


@pytest.fixture(scope="module")
def own():
    return make(RUNS)


@pytest.mark.costs(6)
@pytest.mark.parametrize("kernel", WITH_AVX2)
def test_runs_have_the_same_bits_on_every_processor_with_avx2(own, kernel):
    if missing := not_emulated(kernel):
        pytest.skip("; ".join(missing))
    assert make_under(kernel, RUNS) == own


def test_runs_use_what_the_kernels_change(own):
    assert set(WITH_AVX2) < set(KERNELS)
    assert all(each["metrics"] and each["failure"] is None for each in own.values())
