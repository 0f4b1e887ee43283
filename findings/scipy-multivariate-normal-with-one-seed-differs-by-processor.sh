#!/bin/sh
# Expectation: with one seed, scipy.stats.multivariate_normal.rvs draws the same numbers on every processor, up to
# rounding.
# Package: scipy 1.17.1, numpy 2.4.6 (its OpenBLAS), x86-64 with AVX2.
# Behaviour: the draws are standard normal numbers times singular vectors of the covariance. Where singular values are
# equal, their vectors are any basis, and rounding decides which one OpenBLAS returns. Another kernel (another
# processor) gives draws that are different numbers, not rounding errors. A covariance with equal correlations is an
# everyday example. The documentation of rvs says nothing of this; random_state is "for reproducibility".
# Output seen: "largest distance between the draws of two kernels: 1.45 standard deviations"
# Exit code: 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet numpy==2.4.6 scipy==1.17.1
cat > "$folder/draw.py" <<'PYTHON'
import numpy as np
from scipy.stats import multivariate_normal

covariance = 0.5 * np.eye(6) + 0.5  # unit variances, correlations of a half
print(*multivariate_normal.rvs(np.zeros(6), covariance, random_state=1).tolist())
PYTHON
haswell=$(OPENBLAS_CORETYPE=Haswell "$folder/venv/bin/python" "$folder/draw.py")
nehalem=$(OPENBLAS_CORETYPE=Nehalem "$folder/venv/bin/python" "$folder/draw.py")
"$folder/venv/bin/python" - "$haswell" "$nehalem" <<'PYTHON'
import sys

one, other = (list(map(float, text.split())) for text in sys.argv[1:])
apart = max(abs(a - b) for a, b in zip(one, other, strict=True))
print(f"largest distance between the draws of two kernels: {apart:.2f} standard deviations")
sys.exit(0 if apart > 0.1 else 1)
PYTHON
