"""What the runner's speed is measured by: `make bench`, or `python -m bench NAME` for one of them."""
