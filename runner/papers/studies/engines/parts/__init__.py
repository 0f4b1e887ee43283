"""Plug-ins of the engines study, registered like those of other packages."""
