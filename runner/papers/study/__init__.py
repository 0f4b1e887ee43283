"""Studies: runs, claims, findings, chapters, checks and reports, read from a study's folder."""
