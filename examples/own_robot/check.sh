#!/bin/sh
# Is the arm as good as when baseline.yaml was written? Exit code 0: yes, 1: it fell short, 2: it could not be run.
cd "$(dirname "$0")" || exit 2
folder=$(runner --plugin controller=gravity_pd.py --plugin trajectory=helix.py --config-dir . experiment=lamp_helix) ||
    exit $?
runner check "$folder" --baseline baseline.yaml
