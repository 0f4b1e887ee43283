"""The printed equations of this work, what they claim to equal, and what a robot does that believes wrong ones."""
