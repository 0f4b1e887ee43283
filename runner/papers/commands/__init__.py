"""The commands on published sources."""
