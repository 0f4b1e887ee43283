"""Skip all tests of compiled code if the library that makes machine code is missing."""

from runner.symbolic.engine import evaluator

collect_ignore_glob = [] if evaluator() else ["test_*.py"]
