"""xArm7 study: reproduction of the path-planning report, with its second part corrected."""
