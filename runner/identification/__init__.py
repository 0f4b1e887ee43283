"""Identification: logs of a real arm to a model of its torques, with intervals."""
