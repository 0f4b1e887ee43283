"""Arithmetic expressions in strings: grammar, evaluator, parser, comparison and Typst typesetting.

The parser returns a tree; expressions never run as Python code.
"""
