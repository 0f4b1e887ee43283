"""Thesis study: reproduction of the Macro/Mini thesis by chapter."""
