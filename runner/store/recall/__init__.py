"""Command cache: the stored run of a command line, found without composing or checking its config.

The key of an entry is a digest of everything that the result depends on:

- the command line and the working folder;
- the content of every config file, URDF and mesh that can be read;
- the source of this package, and the installed packages.

A result that may depend on anything else is not cached.
"""
