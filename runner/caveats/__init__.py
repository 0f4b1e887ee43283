"""Caveats: rules that check a finished run for misleading results."""
