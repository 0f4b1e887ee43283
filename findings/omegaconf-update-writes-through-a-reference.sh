#!/usr/bin/env bash
# Expected: where `own.period` is a reference to `shared.period`, an update of `own.period.a` concerns `own` only.
# omegaconf 2.3.1 replaces the reference by a mapping with this value.
# omegaconf 2.4.1rc1 changes the mapping that is referred to, so that each other reference to it changes as well.
# Output: 2.3.1 {'a': 1, 'b': 2} {'a': 9}
#         2.4.1rc1 {'a': 9, 'b': 2} {'a': 9, 'b': 2}
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for version in 2.3.1 2.4.1rc1; do
    python3 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet "omegaconf==$version"
    "$folder/$version/bin/python" - <<'END' >> "$folder/found"
import omegaconf
from omegaconf import OmegaConf

config = OmegaConf.create({"shared": {"period": {"a": 1, "b": 2}}, "own": {"period": "${shared.period}"}})
OmegaConf.update(config, "own.period.a", 9, merge=True)
print(omegaconf.__version__, config.shared.period, config.own.period)
END
done
cat "$folder/found"
grep -q "^2.3.1 {'a': 1, 'b': 2} " "$folder/found"
grep -q "^2.4.1rc1 {'a': 9, 'b': 2} " "$folder/found"
