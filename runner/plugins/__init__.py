"""Registry of kinds, discovery of plug-ins, and the guard around user-supplied parts."""
