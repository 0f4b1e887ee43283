"""Writers of the generated pages, pictures and tables of the docs, and the build of the site."""
