#!/bin/sh
# Expectation: PyBullet computes in double precision, so getLinkState gives the position of a link to about 1e-16 m.
# Package: pybullet 3.2.7 with numpy 2.4.6.
# Behaviour: joint states and the mass matrix have double precision, and positions of link frames have single precision,
# also with computeForwardKinematics. Forward kinematics by hand and by getLinkState differ by 1e-8 to 1e-7 of a metre.
# Output seen: "joint state off by 0, link position off by 1e-08 to 1e-06 m"
# Exit code: 1 if the behaviour changes; 0 otherwise.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet numpy==2.4.6 pybullet==3.2.7
cat > "$folder/arm.urdf" <<'URDF'
<robot name="arm"><link name="base"/>
<link name="l1"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="q" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<link name="tip"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="end" type="fixed"><parent link="l1"/><child link="tip"/><origin xyz="0.7 0.1 0"/></joint></robot>
URDF
cat > "$folder/position.py" <<'PYTHON'
import math
import sys

import pybullet

client = pybullet.connect(pybullet.DIRECT)
body = pybullet.loadURDF(sys.argv[1], useFixedBase=True)
worst = off = 0.0
for number in range(1, 20):
    q = 0.1 * number
    pybullet.resetJointState(body, 0, q)
    position = pybullet.getLinkState(body, 1, computeForwardKinematics=1)[4]
    x, y = 0.7 * math.cos(q) - 0.1 * math.sin(q), 0.7 * math.sin(q) + 0.1 * math.cos(q)
    worst = max(worst, abs(position[0] - x), abs(position[1] - y))
    off = max(off, abs(pybullet.getJointState(body, 0)[0] - q))
print(f" ends, worst {worst}")
single = "1e-08 to 1e-06" if 1e-8 < worst < 1e-6 else f"{worst:g}"
print(f"joint state off by {off:g}, link position off by {single} m")
PYTHON
seen=$("$folder/venv/bin/python" "$folder/position.py" "$folder/arm.urdf" | tail -n 1)
echo "$seen"
test "$seen" = "joint state off by 0, link position off by 1e-08 to 1e-06 m"
