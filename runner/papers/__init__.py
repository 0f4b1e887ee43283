"""Published sources and what serves them: the engine of studies, the studies, and the audit of equations."""
