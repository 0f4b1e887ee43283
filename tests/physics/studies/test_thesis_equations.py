"""The audit of the thesis: its verdicts, what it finds of them, and that it would find more."""

import re
from collections import Counter

import numpy as np
import pytest

from runner.papers.audit.derivations import along
from runner.papers.audit.entry import entries, parts, values_at
from runner.papers.audit.evaluation import evaluate
from runner.papers.audit.verdict import AuditError, Check
from runner.papers.expressions.parser import parse
from runner.papers.studies.thesis.equations.derivations import thesis_measures, thesis_operational
from runner.papers.studies.thesis.equations.derivations.thesis import regular_symbols, symbols, symbols_at
from runner.papers.studies.thesis.equations.derivations.thesis_arms import COMBINED, MACRO, MINI

WRONG = {
    "J_ij",
    "3.4",
    "3.5",
    "3.6",
    "P_ij",
    "3.16",
    "G",
    "sizes",
    "frame-3",
    "theta",
    "J_v6",
    "4.5",
    "g-mini",
    "reference",
    "held",
}
EMENDED = {"J_v3", "motion", "3T6", "names-45", "names-456", "G-mini", "motion-mini"}
EMENDED |= {f"appendix-{torque}" for torque in range(1, 7)}
NAMES = {"epsilon", "3.7", "3.18", "3.22", "3.23", "3.31", "3.33", "3.35", "exact", "3.39", "3.40", "3.42", "4.3"}

ENTRIES = {entry.id.removeprefix("thesis-"): (part, entry) for part, entry in entries("thesis")}


@pytest.fixture(scope="module")
def checked():
    return {
        each.entry.id.removeprefix("thesis-"): each
        for part in parts("thesis")
        for check in [Check(part, samples=100)]
        for each in map(check.check, part.entries)
    }


def test_verdicts(checked):
    found = {name: each.verdict for name, each in checked.items()}
    assert {name for name, verdict in found.items() if verdict == "wrong as printed"} == WRONG
    assert {name for name, verdict in found.items() if verdict == "correct after emendation"} == EMENDED
    assert {name for name, verdict in found.items() if verdict == "definition"} == NAMES
    assert Counter(found.values())["correct"] == len(ENTRIES) - len(WRONG) - len(EMENDED) - len(NAMES)


def test_identifiers_are_unique():
    assert len(ENTRIES) == sum(len(part.entries) for part in parts("thesis"))


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("J_v6", 0.9),  # 1 for 1/10 on a cosine
        ("theta", np.pi / 2),
        ("3.5", np.sqrt(2.0)),  # an axis in the place of one at a right angle to it
        ("3.6", 1.0),  # the last link, 1 m long, is missing from its own column
    ],
)
def test_how_wrong(checked, name, size):
    assert checked[name].measured.largest == pytest.approx(size, rel=0.02)


@pytest.mark.parametrize(
    ("name", "element", "old", "new"),
    [
        ("0TE", "T", "1/2*s12 - ", "1/2*c12 - "),
        ("0T2", "T", "s1*s2", "-s1*s2"),
        ("J_M", "J", "[0, -s23", "[1/1000000, -s23"),
        ("M", "M", "3/2", "1/2"),
        ("B", "B", "-2*cos", "2*cos"),
        ("C", "C", "-c3", "c3"),
        ("J_m", "J", "1/20*s456", "1/10*s456"),
        ("M-mini", "M", "1/500", "1/1000"),
        ("table-3.1-angles", "alpha_3", "pi/2", "-pi/2"),
        ("table-2.1-mini-mass", "m_6", "0.1", "0.11"),
        ("solve", "c_0", "x_0", "x_t"),
        ("3.38", "k_v", "2*xi", "xi"),
    ],
)
def test_a_planted_error_is_found(name, element, old, new):
    part, entry = ENTRIES[name]
    text = entry.printed.elements[element]
    assert old in text
    changed = entry.printed.elements | {element: text.replace(old, new, 1)}
    printed = entry.printed.model_copy(update={"elements": changed})
    check = Check(part, samples=50)
    with pytest.raises(AuditError, match="is wrong by"):
        check.check(entry.model_copy(update={"printed": printed}))
    both = check.check(entry.model_copy(update={"printed": printed, "corrected": entry.printed}))
    assert both.verdict == "wrong as printed"
    assert both.second.largest == pytest.approx(both.measured.largest, rel=1e-4)


@pytest.mark.parametrize("name", ["motion", "G-mini", "motion-mini", "3T6", "J_v3"])
def test_an_emendation_changes_torn_subscripts_alone(name):
    entry = ENTRIES[name][1]
    torn = {
        "s2*s3": "s23",
        "s5*s6": "s56",
        "c5*s6": "c56",
        "s1*23": "s123",
        "c1*23": "c123",
        "s1*2": "s12",
        "c1*2": "c12",
        "-s2*3": "-s23",
    }
    for element, printed in entry.printed.elements.items():
        mended = printed
        for before, after in torn.items():
            mended = mended.replace(before, after)
        # c4*s5 denotes both c456 and c45: with three joints before the difference of three, with two elsewhere
        mended = re.sub(r"([cs])4\*s5", r"\g<1>45", mended) if name == "3T6" else mended
        emended = entry.emendation.elements[element]
        assert mended == (emended.replace("456", "45") if name == "3T6" else emended), element


@pytest.mark.parametrize(
    ("name", "shape"),
    [("0TE", (4, 4)), ("3T6", (4, 4)), ("J_M", (6, 3)), ("J_m", (6, 3)), ("M", (3, 3)), ("M-mini", (3, 3))],
)
def test_a_matrix_has_all_its_elements(name, shape):
    (text,) = ENTRIES[name][1].printed.elements.values()
    assert evaluate(parse(text), symbols_at(np.zeros((1, 6)))).shape == (1, *shape)


# The basis of the derivations.


@pytest.mark.parametrize("arm", [MACRO, MINI, COMBINED])
def test_the_chain_is_the_model(arm):
    values = symbols(20, np.random.default_rng(3))
    q, dq, model = arm.q(values), arm.dq(values), arm.model
    M, V, G, T = 0.0, 0.0, arm.weight(q), arm.frame(len(arm.a), q)
    for link, mass in enumerate(arm.masses, start=1):  # point masses, by d'Alembert's principle
        J = arm.end_jacobian(link, q)[:, :3]
        M = M + mass * J.transpose(0, 2, 1) @ J
        V = V + mass * along(J.transpose(0, 2, 1), arm.bias_acceleration(link, q, dq))
    for row in range(20):
        np.testing.assert_allclose(T[row], model.tip_pose(q[row]), atol=1e-12)
        np.testing.assert_allclose(M[row], model.mass_matrix(q[row]), atol=1e-12)
        np.testing.assert_allclose(V[row], model.coriolis_torque(q[row], dq[row]), atol=1e-10)
        np.testing.assert_allclose(G[row], model.gravity_torque(q[row]), atol=1e-9)


def test_regular_samples_keep_off_singular_postures():
    values = regular_symbols(500, np.random.default_rng(0))
    for arm in (MACRO, MINI):
        J = np.array([arm.model.tip_jacobian(q)[:3] for q in arm.q(values)]) / arm.a[2]
        assert np.abs(np.linalg.det(J)).min() > 0.049
    assert len(values["q1"]) == 500


def test_names_of_sums_and_differences():
    values = symbols_at(np.array([[0.1, 0.2, 0.4, 0.5, 0.6, 0.7]]))
    assert values["c123"][0] == pytest.approx(np.cos(0.7))
    assert values["s1_2_3"][0] == pytest.approx(np.sin(-0.5))
    assert values["c56"][0] == pytest.approx(np.cos(1.3))
    assert values["s4_5"][0] == pytest.approx(np.sin(-0.1))


def test_the_numbers_of_the_finding_on_chained_tables():
    def tip(q):
        arms = {"T_0E": MACRO.frame(3, q[:, :3]), "T_36": MINI.frame(3, q[:, 3:])}
        return values_at("thesis", "thesis-frame-3", arms)["T"][:, :3, 3]

    np.testing.assert_allclose(tip(np.zeros((1, 6)))[0], [0.1, 1.1, 1.0], atol=1e-12)
    q = COMBINED.q(symbols(1000, np.random.default_rng(0)))
    off = np.linalg.norm(tip(q) - COMBINED.frame(6, q)[:, :3, 3], axis=1)
    assert off.max() == pytest.approx(0.35, abs=0.005)


def test_the_mini_s_printed_weight_holds_while_its_base_stands_upright():
    upright = symbols_at(np.array([[0.7, 0.4, -0.4, 0.1, -0.8, 1.2]]))  # link 3 is as at home, turned about z
    links = {f"J_v_{i}": MINI.end_jacobian(i - 3, MINI.q(upright))[:, :3] for i in (5, 6)}
    masses = {f"m_{i}": np.array([MINI.masses[i - 4]]) for i in (5, 6)}
    printed = values_at("thesis", "thesis-g-mini", upright | links | masses)["G"]
    np.testing.assert_allclose(printed, thesis_measures.riding_weight.first(upright)["G"], atol=1e-12)


def test_the_closed_loop_decays_as_the_gains_say():
    values = thesis_operational.symbols(5, np.random.default_rng(0))
    found = thesis_operational.goal_closed.first(values)["ddx"]
    q, dq = MACRO.q(values), MACRO.dq(values)
    x = MACRO.frame(3, q)[:, :3, 3]
    dx = along(MACRO.end_jacobian(3, q)[:, :3], dq)
    np.testing.assert_allclose(found, -60.0 * dx - 900.0 * (x - [0.1679, -0.7571, 0.4255]), atol=1e-7)
