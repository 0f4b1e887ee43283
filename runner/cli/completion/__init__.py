"""Shell completion, by argcomplete."""
