"""Values that differ between the configs of two sweeps, and those that follow from others."""

from dataclasses import replace

from support.sample_sides import LAWS, side

from runner.base.machine import Machine
from runner.reporting.comparison.differences import ABSENT, Value, find_differences
from runner.reporting.comparison.pairs import match


def nothing(*_):
    return 1.0


def found(a, b):
    return find_differences(match(a, b))


def test_one_value_differs_alone():
    a, b = (side(name, LAWS, nothing, noise={"position": size}) for name, size in (("A", 1e-3), ("B", 1e-4)))
    differences = found(a, b)
    assert list(differences.values) == [Value("noise.position", "0.001", "0.0001")]
    assert differences.in_words("A", "B") == "A and B differ only in noise.position: 0.001 against 0.0001."


def test_an_option_differs_alone_where_only_one_has_its_other_values():
    a = side("A", LAWS, nothing, controller={"kind": "computed_torque", "gain": 30.0, "integral_gain": 0.0})
    b = side("B", LAWS, nothing, controller={"kind": "operational_space", "gain": 30.0, "null_space": "none"})
    differences = found(a, b)
    assert differences.in_words("A", "B") == (
        "A and B differ only in controller: computed_torque against operational_space."
    )
    assert differences.values == []


def test_a_gain_that_both_laws_have_is_named_beside_them():
    a = side("A", LAWS, nothing, controller={"kind": "computed_torque", "gain": 30.0}, plant={"step": 1e-3})
    b = side("B", LAWS, nothing, controller={"kind": "operational_space", "gain": 5.0}, plant={"step": 1e-4})
    differences = found(a, b)
    assert differences.names == ["controller", "controller.gain", "plant.step"]
    assert differences.in_words("A", "B") == (
        "A and B differ in controller (computed_torque against operational_space), and also in controller.gain, "
        "plant.step. What follows may be due to any of these."
    )


def test_what_follows_from_other_values_stands_behind_them():
    a = side("A", LAWS, nothing, plant={"step": 1e-3}, controller={"kind": "a", "period": 0.01})
    b = side("B", LAWS, nothing, plant={"step": 5e-4}, controller={"kind": "a", "period": 0.005})
    assert found(a, b).names == ["controller.period", "plant.step"]


def test_values_that_differ_at_some_cells_say_where():
    a, b = side("A", LAWS, nothing, noise={"position": 1e-3}), side("B", LAWS, nothing, noise={"position": 1e-3})
    b.configs[3][0]["noise"] = {"position": 1e-4}
    assert list(found(a, b).values) == [Value("noise.position", "0.001", "0.0001", "robot=xarm7, gravity=9.81")]


def test_another_robot_is_one_thing_and_what_it_proposes_another():
    a = side("A", {"gravity": [9.6, 9.81]}, nothing, robot={"name": "macro", "tip": "tip", "settling_band": 0.02})
    b = side("B", {"gravity": [9.6, 9.81]}, nothing, robot={"name": "xarm7", "tip": "flange", "settling_band": 0.001})
    assert found(a, b).names == ["robot", "robot.settling_band"]


def test_of_the_same_robot_everything_counts():
    a = side("A", {"gravity": [9.6, 9.81]}, nothing, robot={"name": "macro", "home": [0, 1]})
    b = side("B", {"gravity": [9.6, 9.81]}, nothing, robot={"name": "macro", "home": [0, 2]})
    assert list(found(a, b).values) == [Value("robot.home", "[0, 1]", "[0, 2]")]


def test_seed_and_repetitions_are_no_difference_of_cells():
    assert found(side("A", LAWS, nothing, repetitions=8), side("B", LAWS, nothing, repetitions=6)).names == []


def test_a_value_that_one_lacks_is_absent():
    a, b = side("A", LAWS, nothing), side("B", LAWS, nothing, push={"force": 1.0})
    assert list(found(a, b).values) == [Value("push.force", ABSENT, "1")]


def test_commits_and_versions_are_told():
    a, b = side("A", LAWS, nothing), side("B", LAWS, nothing)
    made = {**b.provenance, "commit": ["def"], "made on": ["2027-01-01"]}
    differences = found(a, replace(b, provenance=made))
    assert list(differences.provenance) == [Value("commit", "abc", "def")]
    assert differences.in_words("A", "B") == "A and B differ in no value."


def made_by(name, *machines, **provenance):
    one = side(name, LAWS, nothing)
    texts = [machine.text for machine in machines]
    return replace(one, provenance={**one.provenance, "machine": texts, **provenance}, machines=machines)


ALPHA = Machine("Alpha", "Linux", "x86-64-v4", openblas="SkylakeX")
BETA = replace(ALPHA, level="x86-64-v3", openblas="Haswell")


def test_the_machine_is_named_where_nothing_else_differs():
    a, b = made_by("A", ALPHA), made_by("B", BETA)
    expected = "x86-64-v4, OpenBLAS SkylakeX against x86-64-v3, OpenBLAS Haswell"
    assert found(a, b).in_words("A", "B") == (
        f"A and B differ only in the machine: {expected}. What follows may be rounding, which can grow."
    )
    newer = made_by("B", BETA, commit=["def"])
    assert found(a, newer).in_words("A", "B") == (
        f"A and B differ in no value, but in the machine ({expected}) and in commit."
    )
    assert found(a, a).in_words("A", "B") == "A and B differ in no value."


def test_machines_whose_parts_are_unknown_are_no_difference():
    a, b = made_by("A", ALPHA), made_by("B", Machine("Alpha", "Linux"))
    assert list(found(a, b).provenance) == []


def test_a_side_of_two_machines_has_them_in_a_list_without_commas_in_commas():
    (value,) = found(made_by("A", ALPHA), made_by("B", ALPHA, BETA)).provenance
    assert (value.a, value.b) == (
        "x86-64-v4, OpenBLAS SkylakeX", "x86-64-v3, OpenBLAS Haswell; x86-64-v4, OpenBLAS SkylakeX",
    )  # fmt: skip
