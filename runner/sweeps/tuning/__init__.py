"""Tuning: numeric keys of a config chosen, trial by trial, so that metrics get better."""
