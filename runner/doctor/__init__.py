"""Inspection of third-party robot files: problems, repairs, and a config folder to start from."""
