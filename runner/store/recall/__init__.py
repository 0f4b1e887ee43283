"""What a command line gave before, recalled without composing or checking its config again.

Each answer is kept under a digest of all that it follows from: what is typed, the folder it is typed in, the content of
every config file, URDF and mesh that can be read, the source of this package and what is installed. An answer that may
follow from anything else is not kept.
"""
