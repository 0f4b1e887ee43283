"""Export for publications: tables in Markdown and LaTeX, figures as separate files."""
