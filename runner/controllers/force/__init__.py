"""Force and contact controllers, force measurements and stability limits."""
