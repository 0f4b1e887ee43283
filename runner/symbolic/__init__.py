"""Arms and torque laws as machine code: the same mathematics as elsewhere, compiled once.

This room alone knows the library that makes machine code. Where that is missing, or a law has no compiled form, all
runs as it does without. The config alone decides, and the library's version stands in a run's hash.
"""
