"""The table of built-in arms in the docs against their files."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from runner.assembly.validation import validate
from runner.config.compose.compose import compose
from runner.config.compose.files import group_options

PAGE = (Path(__file__).parents[3] / "docs" / "robots.md").read_text()
ROWS = {
    name: [cell.strip() for cell in line.strip("|\n").split("|")]
    for line in PAGE.partition("## Add a robot")[0].splitlines()
    if line.startswith("| `")
    for name in re.findall(r"`(\w+)`", line.split("|")[1])
}


def test_every_arm_of_one_maker_has_a_row():
    others = set(re.findall(r"`(\w+)`", PAGE.partition("Also built in")[2].partition("\n\n")[0]))
    assert set(ROWS) | others == set(group_options("robot"))


@pytest.mark.parametrize("name", ROWS)
def test_a_row_tells_what_the_file_holds(name):
    _, joints, reach, payload, mass, armature, _ = ROWS[name]
    run = validate(compose((f"robot={name}",)))
    robot, arm = run.robot, run.arm
    assert int(joints) == arm.model.nq
    assert f"reach {reach} m, payload {payload}" in group_options("robot")[name]
    links = ET.fromstring(arm.urdf).iter("inertial")
    tool = 0.0 if robot.tool is None else robot.tool.mass
    total = sum(float(link.find("mass").get("value")) for link in links) - tool
    assert float(mass.split(",")[0]) == pytest.approx(total, abs=0.05)
    given = robot.armature if isinstance(robot.armature, str) else f"{robot.armature:g}"
    assert armature.strip("`").startswith(given)
