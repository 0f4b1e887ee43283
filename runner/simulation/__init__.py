"""The parts of a closed loop: what is told to the plant at each tick, and what is kept of it."""
