"""Challenge of a stored comparison: its question, its sentences and its page."""
