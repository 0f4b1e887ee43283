"""Control laws of an arm mounted on another arm."""
