"""Lets the tests and the processes that they start write bytecode: each would compile every module again."""

import os
import sys

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # of processes to come
sys.dont_write_bytecode = False
