"""Reports: documents of typed blocks from stored runs, rendered to HTML and PDF."""
