"""Precision study: computing time and integration error of the plants."""
