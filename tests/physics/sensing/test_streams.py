"""Random streams of many runs at once, against NumPy's own, one by one."""

import numpy as np
import pytest

from runner.sensing.encoders import EncoderNoise, JointEncoders, encoder_errors
from runner.sensing.streams import generators

LARGE = [0, 1, 7, 2**31, 2**32 - 1, 2**32, 2**40 + 3, 2**64 - 1, 2**64, 2**70 + 5, 2**200 + 3]


def some_numbers():
    draw = np.random.default_rng(5)
    yield from ([seed, repetition, place] for seed in range(40) for repetition in range(20) for place in (0, 1))
    yield from ([a, b, c] for a in LARGE for b in LARGE for c in (0, 3, 2**32 - 1, 2**64))
    for _ in range(1000):
        words = draw.integers(0, 4, size=3)
        yield [int.from_bytes(draw.bytes(4 * int(count)), "little") for count in words]


def test_every_stream_is_numpy_s():
    numbers = list(some_numbers())
    assert len(numbers) > 3000
    for own, generator in zip(numbers, generators(numbers), strict=True):
        theirs = np.random.default_rng(own)
        assert generator.bit_generator.state == theirs.bit_generator.state, own
        assert generator.random() == theirs.random()


@pytest.mark.parametrize("length", [1, 2, 4, 5, 9])
def test_so_it_is_for_any_count_of_numbers(length):
    numbers = [[run * 1_000_003**k for k in range(length)] for run in range(50)]
    for own, generator in zip(numbers, generators(numbers), strict=True):
        assert generator.bit_generator.state == np.random.default_rng(own).bit_generator.state


def test_draws_of_one_run_leave_no_trace_in_the_next():
    numbers = [[0, run, 0] for run in range(6)]
    for own, generator in zip(numbers, generators(numbers), strict=True):
        generator.integers(0, 100, dtype=np.uint32)  # half of a word; PCG64 keeps the rest for later
        expected = np.random.default_rng(own)
        expected.integers(0, 100, dtype=np.uint32)
        assert generator.integers(0, 2**31, dtype=np.uint32) == expected.integers(0, 2**31, dtype=np.uint32)


@pytest.mark.parametrize("distribution", ["uniform", "gaussian", "none"])
@pytest.mark.parametrize("joints", [1, 3, 7])
def test_errors_of_many_runs_are_those_of_the_encoders_one_by_one(distribution, joints):
    draw, ticks = np.random.default_rng(3), 41
    noises = [
        EncoderNoise(
            draw.uniform(0.0, 1e-3, joints), draw.normal(size=joints) * biased, np.zeros(joints), distribution, "exact"
        )
        for biased in (0.0, 1e-3, 0.0)
    ]
    seeds = [[seed, repetition, place] for seed in (0, 3, 2**80) for repetition in range(40) for place in (0, 1)]
    of_runs = [noises[run % 3] for run in range(len(seeds))]
    found = encoder_errors(of_runs, seeds, ticks)
    assert found.shape == (len(seeds), ticks, joints)
    for noise, seed, errors in zip(of_runs, seeds, found, strict=True):
        theirs = np.random.default_rng(seed)
        shape = (ticks, joints)
        drawn = {
            "uniform": lambda: theirs.uniform(-1.0, 1.0, shape),  # noqa: B023 - called at once
            "gaussian": lambda: theirs.standard_normal(shape),  # noqa: B023
            "none": lambda: np.zeros(shape),  # noqa: B023
        }[distribution]()
        expected = noise.position * drawn
        assert errors.tobytes() == (expected + noise.bias if noise.bias.any() else expected).tobytes()
        alone = JointEncoders(ticks, 0.01, noise, np.random.default_rng(seed)).errors
        assert errors.tobytes() == alone.tobytes()
