"""Config of a run: models of its groups, checks, and composition."""
