"""Registry of kinds, plug-in discovery, and runtime checks of plug-ins."""
