"""Published works: a folder each. Nothing below this package knows a work, and no work knows another."""
