"""Reports: documents of typed blocks made from stored runs, rendered to HTML and PDF."""
