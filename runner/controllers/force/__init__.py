"""Control laws for contact, and the readings of force that they use."""
