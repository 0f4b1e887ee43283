"""The vocabulary of a run: composing configs, checking them, and what a checked config is."""
