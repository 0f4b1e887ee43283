#!/bin/sh
# Expectation: factors.solve(b) has the shape of b, as in numpy.linalg.solve; so a system of one unknown needs no branch.
# Package: eigenpy 3.13.0 (Pinocchio's interface to Eigen).
# Behaviour: a vector of one number comes back as a matrix, and a row or a column of several right sides as a vector.
# Code for n joints therefore works for each n but 1: an assignment or an index then raises, or broadcasts.
# Output seen: "(1,) gives (1, 1); (2,) gives (2,); (1, 3) gives (3,); (2, 1) gives (2,); (2, 3) gives (2, 3)"
# Exit code: 1 if the behaviour changes; 0 otherwise.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet eigenpy==3.13.0
cat > "$folder/shapes.py" <<'PYTHON'
import eigenpy
import numpy as np

shapes = ((1,), (2,), (1, 3), (2, 1), (2, 3))
found = [eigenpy.LLT(2.0 * np.eye(shape[0])).solve(np.ones(shape)).shape for shape in shapes]
print("; ".join(f"{shape} gives {own}" for shape, own in zip(shapes, found)))
PYTHON
seen=$("$folder/venv/bin/python" "$folder/shapes.py")
echo "$seen"
test "$seen" = "(1,) gives (1, 1); (2,) gives (2,); (1, 3) gives (3,); (2, 1) gives (2,); (2, 3) gives (2, 3)"
