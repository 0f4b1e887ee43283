"""Shell completion: candidates for the last word of a partly typed command line.

The shell functions of Hydra's `-sc install=bash` call `runner -sc query=bash`, with the line in COMP_LINE. For any
input, only candidate words are printed. Words that need no config are completed without importing Hydra.
"""

from runner.cli.completion.answer import answer, is_asked

__all__ = ["answer", "is_asked"]
