"""What leaves for a paper: tables in Markdown and LaTeX, figures as files of their own."""
