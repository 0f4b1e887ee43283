#!/usr/bin/env bash
# Expected: sort() puts the values of a sweep in order, so sort(range(5,0,-2)) has 1, 3 and 5.
# hydra-core 1.3.8: it exchanges start and stop, and runs 2, 4 and 6. The value 6 is outside the range that was typed.
# Output: range(5,0,-2): 5 3 1
#         sort(range(5,0,-2)): 2 4 6
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet hydra-core==1.3.8
"$folder/venv/bin/python" - <<'END'
import sys

from hydra.core.override_parser.overrides_parser import OverridesParser


def values(text):
    (override,) = OverridesParser.create().parse_overrides([f"n={text}"])
    found = list(override.sweep_string_iterator())
    print(f"{text}: {' '.join(found)}")
    return found


same = values("range(5,0,-2)") == ["5", "3", "1"] and values("sort(range(5,0,-2))") == ["2", "4", "6"]
sys.exit(not same)
END
