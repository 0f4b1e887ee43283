"""Figures as plain data and as SVG: curves, heat maps, robot models and control structures."""
