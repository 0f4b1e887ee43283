"""The laws of arm control against each other."""
