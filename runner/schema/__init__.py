"""Config building blocks: base model, values per joint and per stage, units, plausible magnitudes."""
