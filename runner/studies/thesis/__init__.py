"""The report that reproduces the Macro-Mini thesis, chapter by chapter."""
