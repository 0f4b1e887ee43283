"""Commands that act some ticks late."""

import functools

import numpy as np
import pytest

H = 0.01  # s, the Macro's period
NEAR = ("robot=macro", "plant=rk4", "gravity=0", "trajectory.start=[0.7,0.6,1.2]", "trajectory.goal=[0.70001,0.6,1.2]")
LINE = ("trajectory=quintic", "trajectory.duration=1", "duration=1.2")
FORWARD = ("robot=xarm7", "controller.feedback=commanded", "controller.null_space.task=none")


def delayed_oscillator(natural_frequency, delay, damping_ratio=1.0):
    """Matrix from tick to tick of a mass led to zero: of x, dx, and the accelerations that wait, a_1 ... a_d."""
    k = np.array([natural_frequency**2, 2.0 * damping_ratio * natural_frequency])
    matrix = np.zeros((2 + delay, 2 + delay))
    matrix[:2, :2] = [[1.0, H], [0.0, 1.0]]
    effect = np.array([0.5 * H**2, H])
    if delay == 0:
        matrix[:2, :2] -= np.outer(effect, k)
    else:
        matrix[:2, 2] = effect
        matrix[2:-1, 3:] = np.eye(delay - 1)
        matrix[-1, :2] = -k
    return matrix


@functools.cache
def limit(delay):
    """Largest omega_n of a critically damped law that is stable at a delay, in rad/s."""
    frequencies = np.linspace(1.0, 200.0, 19901)
    matrices = np.array([delayed_oscillator(f, delay) for f in frequencies])
    stable = np.abs(np.linalg.eigvals(matrices)).max(axis=1) < 1.0
    return frequencies[stable.tolist().index(False)]


def test_without_delay_theory_ends_stability_at_the_known_product():
    """The characteristic polynomial of a sampled mass: xi wn h = 1."""
    assert limit(0) * H == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("delay", [0, 1, 2, 5])
def test_an_error_that_is_led_to_zero_goes_as_a_sampled_mass_with_delay_does(simulated, delay):
    frequency = 0.6 * limit(delay)
    trace = simulated(
        *NEAR, f"controller.natural_frequency={frequency}", f"plant.computation.delay={delay}", "duration=1"
    )
    state = np.array([-1e-5, 0.0, *[frequency**2 * 1e-5] * delay])  # the first command is there from the start
    expected = []
    for _ in trace.t:
        expected.append(-state[0])
        state = delayed_oscillator(frequency, delay) @ state
    np.testing.assert_allclose(trace.error[:, 0], expected, atol=1e-3 * 1e-5)


@pytest.mark.parametrize("delay", [1, 2, 5])
def test_stability_ends_where_theory_says(simulated, delay):
    def grows(factor):
        law = f"controller.natural_frequency={factor * limit(delay)}"
        error = np.abs(simulated(*NEAR, law, f"plant.computation.delay={delay}", "duration=8").error[:, 0])
        return error[-100:].max() > error[300:400].max()

    assert not grows(0.98)
    assert grows(1.02)


def test_a_trace_holds_the_torques_that_act(simulated):
    prompt, late = (simulated("robot=macro", *LINE, f"plant.computation.delay={delay}") for delay in (0, 3))
    np.testing.assert_array_equal(late.tau[:4], np.tile(prompt.tau[0], (4, 1)))
    assert not np.array_equal(late.tau[5], late.tau[4])


@pytest.mark.parametrize("delay", [1, 3, 10])
def test_joints_led_without_feedback_move_as_without_delay_but_later(simulated, delay):
    prompt = simulated(*FORWARD, *LINE)
    late = simulated(*FORWARD, *LINE, f"plant.computation.delay={delay}")
    np.testing.assert_array_equal(late.q[delay + 1 :], prompt.q[1:-delay])
    np.testing.assert_array_equal(late.q_command, prompt.q_command)
    assert np.abs(late.q - prompt.q).max() > 1e-3


@pytest.mark.parametrize("ticks", [3, 10, 25])
def test_servos_move_evenly_from_one_late_command_to_the_next(simulated, ticks):
    """Ten servo periods to a command: a delay of any number of them only shifts the motion."""
    servo = (*FORWARD, "plant=rk4", *LINE)
    prompt, late = simulated(*servo), simulated(*servo, f"plant.computation.delay={ticks}")
    np.testing.assert_allclose(late.q[ticks:], prompt.q[:-ticks], atol=2e-6)  # the very first command is a jump
    assert np.abs(late.q - prompt.q).max() > 1e-3


def test_a_delay_counts_where_a_wall_is_judged(cli):
    assert cli("experiment=meca500/wall", "duration=0.01").code == 0
    ending = cli("experiment=meca500/wall", "plant.computation.delay=50")
    assert ending.code == 2
    assert "controller.period: at 0.001 s the admittance along x is unstable against a wall" in ending.err


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (("robot=macro", "plant.computation.delay=0.5"), "plant.computation.delay: must be a whole number; found 0.5"),
        (("robot=xarm7", "plant.computation.delay=-1"), "plant.computation.delay: must be 0 or more; found -1"),
        (("robot=combined", "plant.computation.delay={macro: 1}"), "plant.computation.delay.mini: missing"),
        (("robot=combined", "plant.computation.delay={macro: 1, mimi: 2}"), "no such loop (did you mean mini?)"),
        (("robot=macro", "plant.computation.miss=1.5"), "plant.computation.miss: must be 1 or less; found 1.5"),
        (("robot=macro", "plant.computation.jitter=[0.5,0.4]"), "probabilities must add up to 1"),
        (("robot=macro", "plant.computation.miss=[1,1]"), "a pattern needs a 0"),
        (("robot=macro", "duration=0.02", "plant.computation.miss=[0,0,0,0,1]"), "a pattern of 5 ticks, and the loop"),
        (("robot=xarm7", "plant.computation.miss=0.1"), "commands joint positions, which come all as late"),
        (
            ("robot=macro", "disturbance_observer=momentum", "plant.computation.miss=0.1"),
            "it has to know which torque acts",
        ),
    ],
)
def test_delays_that_cannot_be(cli, overrides, message):
    ending = cli(*overrides)
    assert ending.code == 2
    assert message in ending.err
