"""Report on the audited equations of the studies."""
