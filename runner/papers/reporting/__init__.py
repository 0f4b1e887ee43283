"""Parts of reports on published sources: verdicts on claims and equations, and the audit."""
