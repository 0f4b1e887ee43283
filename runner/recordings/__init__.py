"""Recordings of real arms, held against stored runs: read, aligned in time, compared, and their friction identified."""
