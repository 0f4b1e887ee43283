#!/bin/sh
# Expectation: PyBullet computes in double precision, so its mass matrix has the URDF's tensor to about 1e-16.
# Package: pybullet 3.2.7 with numpy 2.4.6.
# Behaviour: each tensor is turned to principal axes only until its products are below 1e-6 of its moments; what remains
# of them is dropped. A body written by products and the same body written by a turned inertial frame thus differ.
# Output seen: "diagonal tensor off by 0, tensor with products off by 1e-09 to 1e-06"
# Exit code: 1 if the behaviour changes; 0 otherwise.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet numpy==2.4.6 pybullet==3.2.7
cat > "$folder/inertia.py" <<'PYTHON'
import sys

import pybullet

ARM = """<robot name="arm"><link name="base"/>
<link name="l1"><inertial><mass value="1"/>
<inertia ixx="1.21" ixy="{0}" ixz="{1}" iyy="1.26" iyz="{2}" izz="1.27"/></inertial></link>
<joint name="q" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0.6 0.8 0"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""
off = []
for number, (xy, xz, yz) in enumerate([(0.0, 0.0, 0.0), (-0.07, 0.07, 0.03)]):
    path = f"{sys.argv[1]}/arm{number}.urdf"  # URDFs are cached by file name
    with open(path, "w") as file:
        file.write(ARM.format(xy, xz, yz))
    client = pybullet.connect(pybullet.DIRECT)
    body = pybullet.loadURDF(path, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
    moment = 0.36 * 1.21 + 0.64 * 1.26 + 2.0 * 0.48 * xy
    off.append(abs(pybullet.calculateMassMatrix(body, [0.0], physicsClientId=client)[0][0] / moment - 1.0))
print(f" ends, off by {off}")
first = "0" if off[0] < 1e-14 else f"{off[0]:g}"
second = "1e-09 to 1e-06" if 1e-9 < off[1] < 1e-6 else f"{off[1]:g}"
print(f"diagonal tensor off by {first}, tensor with products off by {second}")
PYTHON
seen=$("$folder/venv/bin/python" "$folder/inertia.py" "$folder" | tail -n 1)
echo "$seen"
test "$seen" = "diagonal tensor off by 0, tensor with products off by 1e-09 to 1e-06"
