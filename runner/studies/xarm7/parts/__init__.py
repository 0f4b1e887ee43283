"""Parts of the runner that this work alone needs, registered as those of other packages are."""
