"""Plug-ins of the xArm7 study, registered like those of other packages."""
