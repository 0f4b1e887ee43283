"""Report on a tuning: history, Pareto front, keys and best trials."""
