"""Engines study: comparison of three physics engines."""
