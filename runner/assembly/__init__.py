"""Assembly of a run from its config: checks, arms, loops, desired motion, and the closed loop."""
