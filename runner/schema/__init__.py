"""Vocabulary of configs: values per joint and per stage, units, plausible magnitudes."""
