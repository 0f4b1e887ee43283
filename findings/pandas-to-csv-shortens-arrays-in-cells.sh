#!/usr/bin/env bash
# Expected: to_csv() writes numbers so that they can be read back. It does for scalars and for lists in cells.
# pandas 3.1.1 with numpy 2.4.6: an array in a cell has nine digits, so that a time since 1970 is wrong by up to 5 s.
# Of an array with more than 1000 numbers only the first three and the last three are written. There is no warning.
# Output: scalar 1764700012.345678
#         list   [1764700012.345678]
#         array  [1.76470001e+09]
#         long   [0.000e+00 1.000e+00 2.000e+00 ... 1.998e+03 1.999e+03 2.000e+03]
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pandas==3.1.1 numpy==2.4.6
"$folder/venv/bin/python" - <<'END'
import csv
import io
import sys

import numpy as np
import pandas as pd

stamp = 1764700012.345678
cells = {"scalar": stamp, "list": [stamp], "array": np.array([stamp]), "long": np.arange(2001.0)}
text = pd.Series(cells, dtype=object).to_csv(header=False)
written = dict(csv.reader(io.StringIO(text)))
for name, cell in written.items():
    print(f"{name:6} {' '.join(cell.split())}")
whole = written["scalar"] == str(stamp) and written["list"] == f"[{stamp}]"
sys.exit(not (whole and written["array"] == "[1.76470001e+09]" and "..." in written["long"]))
END
