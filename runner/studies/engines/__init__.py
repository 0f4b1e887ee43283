"""The report that holds three physics engines against each other."""
