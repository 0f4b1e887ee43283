"""What TAB completes: the words that may stand at the end of a half typed command line.

The shell functions of Hydra's `-sc install=bash` ask by `runner -sc query=bash`, with the line in COMP_LINE. Whatever
is typed, nothing is printed but words; what needs no config is answered without importing Hydra.
"""

from runner.cli.completion.answer import answer, is_asked

__all__ = ["answer", "is_asked"]
