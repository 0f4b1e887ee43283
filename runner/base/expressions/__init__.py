"""Arithmetic as text: parsed into a tree, never run as code, and set in Typst."""
