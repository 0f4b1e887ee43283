import numpy as np
import pytest


@pytest.mark.parametrize(("robot", "scale"), [("macro", 1.0), ("mini", 0.1)])
@pytest.mark.parametrize("end", [1.5, 2.0])  # s: in motion, and where it ends
def test_bullet_converges_to_rk4_at_first_order(simulated, robot, scale, end):
    period = 0.01 * scale

    def final_state(plant, steps_per_tick):
        trace = simulated(
            f"robot={robot}",
            f"plant={plant}",
            f"plant.step={period / steps_per_tick!r}",
            "trajectory=quintic",
            f"trajectory.duration={2.0 * scale}",
            f"duration={end * scale}",
        )
        assert trace.failure is None
        assert trace.t[-1] == pytest.approx(end * scale)
        return np.concatenate([trace.q[-1], trace.dq[-1] * scale])

    reference = final_state("rk4", 4)
    differences = [np.linalg.norm(final_state("bullet", n) - reference) for n in (5, 10, 20, 40)]
    ratios = np.divide(differences[1:], differences[:-1])
    assert ratios.min() > 0.45
    assert ratios.max() < 0.55
