"""What reports on published sources add: verdicts on claims and equations, and the audit."""
