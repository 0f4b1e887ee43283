"""Config composition: Hydra, overrides, units of input and error messages."""
