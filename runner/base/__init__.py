"""Errors, text for people, paths, bounded YAML, progress, traces and the expression evaluator."""
