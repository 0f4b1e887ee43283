"""Nothing of the compiled room can be tried where the library that makes machine code is missing."""

from runner.symbolic.engine import evaluator

collect_ignore_glob = [] if evaluator() else ["test_*.py"]
