"""What writes the generated pages, pictures and tables of the docs, and what builds the site."""
