"""Maps from columns to signals: names, factors and units, and what does not fit."""

import pytest

from runner.base.errors import RunnerError
from runner.recordings.columns_map import Signal, read_map

JOINTS, UNITS = ("q1", "slide"), ("rad", "m")


def read(tmp_path, text):
    path = tmp_path / "map.yaml"
    path.write_text(text)
    return read_map(path, JOINTS, UNITS)


def test_signals_and_factors(tmp_path):
    said, factors = read(
        tmp_path,
        """
        time: {column: t, unit: ms}
        columns:
          a: {joint: q1, unit: deg}
          b: {joint: slide, unit: mm}
          c: {torque: q1, unit: A, constant: -1.6}
          d: {torque: slide, unit: kN}
          e: {tip: z, unit: cm}
        """,
    )
    assert [column.signal for column in said.columns.values()] == [
        Signal("position", "q1"),
        Signal("position", "slide"),
        Signal("torque", "q1"),
        Signal("torque", "slide"),
        Signal("tip", "z"),
    ]
    assert {name: tuple(factor) for name, factor in factors.items()} == {
        "t": (pytest.approx(1e-3), "s"),
        "a": (pytest.approx(0.017453292519943295), "rad"),
        "b": (pytest.approx(1e-3), "m"),
        "c": (-1.6, "N m"),
        "d": (pytest.approx(1e3), "N"),
        "e": (pytest.approx(1e-2), "m"),
    }


@pytest.mark.parametrize(
    ("columns", "wanted"),
    [
        ("{a: {joint: q1, unit: rad}, b: {joint: q1, unit: rad}}", "a and b both hold the position of q1; leave one"),
        ("{a: {joint: slid, unit: m}}", "columns.a: the robot has no joint 'slid' (did you mean slide?); joints: q1"),
        ("{a: {joint: q1, unit: degree}}", "columns.a.unit: must be one of rad, mrad, deg; found 'degree' (did you"),
        ("{a: {joint: slide, unit: rad}}", "columns.a.unit: must be one of m, cm, mm, um; found 'rad'"),
        ("{a: {joint: q1}}", "columns.a.unit: Field required"),
        (
            "{a: {unit: rad}}",
            "must say one of joint, velocity, acceleration, reference, torque and tip; found none of them",
        ),
        (
            "{a: {joint: q1, tip: x, unit: rad}}",
            "must say one of joint, velocity, acceleration, reference, torque and tip; found joint and tip",
        ),
        ("{a: {torque: q1, unit: A}}", "a current needs constant, in N m/A"),
        ("{a: {torque: q1, unit: N m, constant: 2.0}}", "a current needs constant, in N m/A, and nothing else"),
        ("{a: {joint: q1, unit: A, constant: 2.0}}", "a current is that of a motor: say by torque whose"),
        ("{a: {torque: q1, unit: A, constant: 0}}", "constant: must not be 0; it is the torque of one ampere"),
        (
            "{a: {torque: q1, unit: A, constant: 1.0e+300}}",
            "columns.a.constant: must lie between 1e-12 and 1e+12 in magnitude; found 1e+300",
        ),
        ("{a: {tip: w, unit: m}}", "columns.a.tip: Input should be 'x', 'y' or 'z'"),
        ("{}", "columns: Dictionary should have at least 1 item"),
        ("{a: {joint: q1, unit: rad, sgn: -1}}", "columns.a.sgn: unknown key (did you mean sign?)"),
        ("{a: {joint: q1, unit: rad, sign: 2}}", "columns.a.sign: Input should be 1 or -1"),
        ('{a: {joint: q1, unit: "%"}}', "a per cent needs scale, its value at 100 %"),
        ("{a: {joint: q1, unit: rad, scale: 2.0}}", "a per cent needs scale, its value at 100 %"),
        ("{a: {joint: q1, unit: rad, holds: torque}}", "holds: is for torques; leave it out"),
        ("{a: {joint: q1, unit: rad, side: link}}", "side: is for torques; leave it out"),
        ("{a: {torque: q1, unit: N m, side: gear}}", "columns.a.side: Input should be 'motor' or 'link'"),
        ("{a: {torque: q1, unit: N m, wrap: 6.28}}", "wrap: is for positions of joints; leave it out"),
        ("{a: {tip: x, unit: m, coupling: {q1: 1.0}}}", "coupling: is for joints; leave it out"),
        ("{a: {joint: q1, unit: rad, coupling: {slide: 1.0}}}", "no other column holds the position of slide"),
        ("{a: {joint: q1, unit: rad, coupling: {q9: 1.0}}}", "no other column holds the position of q9"),
        (
            "{a: {torque: q1, unit: N m, holds: commanded}, b: {torque: slide, unit: N}}",
            "columns: holds must be the same for all torques",
        ),
    ],
)
def test_what_does_not_fit_is_named(tmp_path, columns, wanted):
    with pytest.raises(RunnerError) as caught:
        read(tmp_path, f"rate: 100.0\ncolumns: {columns}\n")
    assert wanted in str(caught.value)


def test_a_column_that_stands_twice(tmp_path):
    with pytest.raises(RunnerError, match=r"map.yaml, line 4: the key 'a' stands twice"):
        read(tmp_path, "rate: 1.0\ncolumns:\n  a: {joint: q1, unit: rad}\n  a: {joint: slide, unit: m}\n")


def test_a_map_without_time(tmp_path):
    with pytest.raises(RunnerError, match=r"needs time, as in time: \{column: t, unit: s\}, or rate"):
        read(tmp_path, "columns: {a: {joint: q1, unit: rad}}\n")


def test_all_problems_of_units_and_joints_at_once(tmp_path):
    with pytest.raises(RunnerError, match=r"no joint 'q3'.*time.unit: must be one of s, ms"):
        read(tmp_path, "time: {column: t, unit: sec}\ncolumns: {a: {joint: q3, unit: rad}}\n")
