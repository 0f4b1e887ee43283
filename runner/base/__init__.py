"""Errors, text and number formatting, paths, bounded YAML, progress, traces and the expression evaluator."""
