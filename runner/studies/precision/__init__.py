"""The report on what the plants' accuracy costs, against a solution that is good to rounding."""
