"""Composing a config: Hydra, overrides, units of input and error messages."""
