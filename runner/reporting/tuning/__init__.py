"""The report on a tuning: history, Pareto front, keys, best trials."""
