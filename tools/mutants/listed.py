"""Mutants written by hand: the location and the error of each."""

from dataclasses import dataclass

from tools.mutants.mutant import Mutant


@dataclass(frozen=True)
class Listed:
    """An error put into a module.

    Attributes:
        why: What is wrong then.
        module: The module, from the root of the checkout.
        right: What is there, once.
        wrong: What is put in its place.
        test: The module's test file.
    """

    why: str
    module: str
    right: str
    wrong: str
    test: str

    def at(self, source: str) -> Mutant:
        """Return the mutant of the module's source.

        Raises:
            ValueError: if the replaced text does not occur exactly once.
        """
        if source.count(self.right) != 1:
            raise ValueError(f"{self.module}: {self.right!r} occurs {source.count(self.right)} times, not once")
        start = len(source.partition(self.right)[0].encode())
        end = start + len(self.right.encode())
        return Mutant(self.module, start, end, self.wrong, self.right, 0, why=self.why, test=self.test)


def _of(module: str, test: str, *errors: tuple[str, str, str]) -> list[Listed]:
    """Return mutants of one module from (why, right, wrong)."""
    return [Listed(why, f"runner/{module}", right, wrong, f"tests/{test}") for why, right, wrong in errors]


MUTANTS = [
    *_of(
        "metrics/reaching.py",
        "unit/metrics/test_reaching.py",
        ("reach counted from the tip", "traces.end_points[-2]", "traces.end_points[-1]"),
        ("reach counted from the first stage", "traces.end_points[-2]", "traces.end_points[0]"),
    ),
    *_of(
        "metrics/contact.py",
        "unit/metrics/test_contact.py",
        ("the force's error against its last sample", "mean(axis=0) - mean)", "mean(axis=0) - force[-1])"),
        ("the last sample's error", "felt[steady].mean(axis=0) - mean", "felt[-1] - mean"),
        ("the largest component for the peak", "np.linalg.norm(force, axis=1).max()", "np.abs(force).max()"),
        ("the mean of magnitudes", "np.linalg.norm(mean)", "np.linalg.norm(force[steady], axis=1).mean()"),
    ),
    *_of(
        "metrics/positioning.py",
        "unit/metrics/test_positioning.py",
        ("overshoot of the desired motion counted", "past - np.maximum(wanted, 0.0)", "past"),
        ("overshoot of an arm that is ahead of its desired motion", "past - np.maximum(wanted, 0.0)", "past - wanted"),
    ),
    *_of(
        "metrics/summary.py",
        "unit/metrics/test_summary.py",
        (
            "the tip judged for a stage",
            "evaluate(at_stage, stage_context)",
            "evaluate(traces, stage_context)",
        ),
        ("the path of a stage not shifted", "context.at_stage(traces.offsets[index])", "context"),
    ),
    *_of(
        "metrics/summary.py",
        "unit/metrics/test_measure.py",
        ("the last block of runs lost", "range(0, len(traces.q), block)", "range(0, len(traces.q) - block, block)"),
    ),
    *_of(
        "store/shards.py",
        "contract/store/test_batch_records.py",
        (
            "the largest for the least",
            "median, low, high = (None",
            "median, high, low = (None",
        ),
    ),
    *_of(
        "metrics/tracking.py",
        "unit/metrics/test_tracking.py",
        ("the tick at t_f lost to rounding", "trajectory.duration + 1e-9", "trajectory.duration"),
    ),
    *_of(
        "metrics/effort.py",
        "unit/metrics/test_effort.py",
        ("a limit missed by rounding", "1.0 - 1e-12", "1.0"),
        (
            "work that cancels",
            "np.abs(held * np.diff(by_rows(traces.q), axis=2)).sum(axis=2)",
            "(held * np.diff(by_rows(traces.q), axis=2)).sum(axis=2)",
        ),
    ),
    *_of(
        "sensing/force_torque.py",
        "physics/sensing/test_force_torque.py",
        (
            "noise fed back through the low-pass",
            "value = self._seen + self._noise[tick]",
            "self._seen = self._seen + self._noise[tick]\n        value = self._seen.copy()",
        ),
        (
            "rounding fed back through the low-pass",
            "/ self._resolution)\n",
            "/ self._resolution)\n        self._seen = value - self._noise[tick]\n",
        ),
        ("noise before the low-pass", "+ self._bias[tick]\n", "+ self._bias[tick] + self._noise[tick]\n"),
        (
            "the bias behind the low-pass",
            "wrench + self._bias[tick]\n",
            "wrench\n        self._noise[tick] += self._bias[tick]\n",
        ),
    ),
    *_of(
        "sensing/streams.py",
        "physics/sensing/test_streams.py",
        ("large seeds cut off", "for more in entropy[_POOL:]", "for more in entropy[:0]"),
    ),
    *_of(
        "sensing/encoders.py",
        "physics/sensing/test_encoders.py",
        ("differences of true positions", "self._period, measured, state)", "self._period, q, state)"),
    ),
    *_of(
        "statistics/effects.py",
        "unit/statistics/test_effects.py",
        ("a factor without the others", "_basis(columns - base @ (base.T @ columns))", "_basis(columns)"),
        ("the share of what is left", "return 1.0 - float(np.sum((y - means", "return float(np.sum((y - means"),
    ),
    *_of(
        "statistics/interval.py",
        "unit/statistics/test_interval.py",
        ("percentiles that are not expanded", "np.sqrt(n / (n - 1)) * stdtrit", "stdtrit"),
    ),
    *_of(
        "controllers/macro_mini/stage_loops.py",
        "physics/controllers/test_stage_loops.py",
        (
            "later stages' offset added",
            "way = reference[0] - parameters.later",
            "way = reference[0] + parameters.later",
        ),
        ("the lower stage adds it", "bases[0][0] - parameters.later", "bases[0][0] + parameters.later"),
        ("the last rider's offset for that of all", "target[0] -= R", "target[0] = reference[0] - R"),
        ("the base's turn the other way round", "cross(moves[3:], way)", "cross(way, moves[3:])"),
        (
            "gravity turned the wrong way",
            "return way, seen[:3], seen[3]",
            "return way, seen[:3], R.dot(numbers.gravity)",
        ),
    ),
    *_of(
        "plants/friction.py",
        "physics/plants/test_friction.py",
        ("viscous friction of a joint that dry friction stops", "(speed - mobility @ mu) + mu", "speed + mu"),
        ("a contact that friction does not know", "self._contact_torque() - bias", "-bias"),
    ),
    *_of(
        "plants/friction_law.py",
        "physics/plants/test_friction_law.py",
        (
            "a static level that moving joints have",
            "backend.select(held[joint], 1.0, self._weight(backend, joint, speed))",
            "1.0",
        ),
        ("a sigmoid that drives a joint", "1.0 + odds * left", "1.0 - odds * left"),
    ),
    *_of(
        "plants/servo.py",
        "physics/plants/test_servo.py",
        ("a world that does not reach the joints", "self.tau + self.load", "self.tau"),
        ("a world that pulls where it pushes", "self.tau + self.load", "self.tau - self.load"),
        ("a spring at the start of the period", "position - q - h * dq)", "position - q)"),
    ),
    *_of(
        "plants/kinematic.py",
        "physics/plants/test_kinematic.py",
        ("a load that helps where it hinders", "ddq) - self.load", "ddq) + self.load"),
    ),
    *_of(
        "plants/runge_kutta.py",
        "physics/plants/test_flexible_joints.py",
        ("each stage from the one before", "return x + (ahead * h) * k, [", "return at + (ahead * h) * k, ["),
    ),
    *_of(
        "calibration/gravity.py",
        "physics/calibration/test_gravity.py",
        ("the moment's bias with the wrong sign", "k + np.cross(r, F_0)", "k - np.cross(r, F_0)"),
    ),
]
