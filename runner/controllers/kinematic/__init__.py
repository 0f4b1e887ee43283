"""Controllers that command joint positions from the motion of the tip."""
