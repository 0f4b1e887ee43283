#!/bin/sh
# Expectation: DataFrame.sort_values(...).head(n) keeps the same rows on every machine; its documentation says of the
# default algorithm only that it is not stable.
# Package: pandas 3.1.1, numpy 2.4.6, x86-64 with AVX2 or AVX-512.
# Behaviour: among rows with equal keys, the rows at the front depend on the processor, because numpy's quicksort has
# another implementation for each instruction set. kind="stable" gives the same rows everywhere.
# Output seen: "first rows here: 0 5 15 10; without AVX2 and AVX-512: 0 35 90 25; stable: 0 5 10 15"
# Exit code: 1 if the behaviour changes; 0 otherwise, also on a processor without AVX2.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet numpy==2.4.6 pandas==3.1.1
cat > "$folder/rows.py" <<'PYTHON'
import sys

import pandas as pd

frame = pd.DataFrame({"score": [float(run % 5) for run in range(100)], "run": range(100)})
print(*frame.sort_values("score", kind=sys.argv[1]).head(4)["run"].tolist())
PYTHON
if ! grep -q avx2 /proc/cpuinfo; then
    echo "this processor has no AVX2: nothing to see"
    exit 0
fi
none="X86_V4 X86_V3 AVX512_ICL AVX512_SPR"
here=$("$folder/venv/bin/python" "$folder/rows.py" quicksort)
without=$(NPY_DISABLE_CPU_FEATURES="$none" "$folder/venv/bin/python" -W ignore "$folder/rows.py" quicksort)
stable=$("$folder/venv/bin/python" "$folder/rows.py" stable)
echo "first rows here: $here; without AVX2 and AVX-512: $without; stable: $stable"
test "$here" != "$without"
test "$stable" = "0 5 10 15"
