"""Tuning: optimization of numeric config keys, trial by trial, for one or more metrics."""
