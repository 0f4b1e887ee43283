"""What the printed equations claim to equal, each worked out in two ways."""
