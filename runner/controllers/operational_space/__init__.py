"""Control laws in operational space, for a whole arm."""
