"""Benchmarks of the runner's speed: `make bench`, or `python -m bench NAME` for one of them."""
