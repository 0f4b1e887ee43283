"""What the equations claim to equal, worked out from the model: one module for each work, or part of one."""
