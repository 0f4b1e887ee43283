#!/bin/sh
# Expectation: x[::-1] is a view of the same numbers, so x[::-1] ** 3 is (x ** 3)[::-1], bit by bit.
# Package: numpy 2.4.6, on x86-64 with AVX-512.
# Behaviour: on AVX-512 the power of a contiguous array is computed by SVML and the power of a view with a negative
# stride by the C library; they differ in the last bit. On a processor without AVX-512 they are equal. Therefore a
# power also has other bits on another processor: x * x * x has the same bits everywhere.
# Output seen: "53 of 1000 cubes of the reversed array differ; without AVX-512: 0"
# Exit code: 1 if the behaviour changes; 0 otherwise, also on a processor without AVX-512.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet numpy==2.4.6
cat > "$folder/cubes.py" <<'PYTHON'
import numpy as np

x = np.random.default_rng(0).uniform(0.0, 1.0, 1000)
print(int(np.sum(x[::-1] ** 3 != (x**3)[::-1])))
PYTHON
if ! grep -q avx512_bw /proc/cpuinfo && ! grep -q avx512bw /proc/cpuinfo; then
    echo "this processor has no AVX-512: nothing to see"
    exit 0
fi
here=$("$folder/venv/bin/python" "$folder/cubes.py")
without=$(NPY_DISABLE_CPU_FEATURES="X86_V4 AVX512_ICL AVX512_SPR" "$folder/venv/bin/python" -W ignore "$folder/cubes.py")
echo "$here of 1000 cubes of the reversed array differ; without AVX-512: $without"
test "$here" -gt 0
test "$without" -eq 0
