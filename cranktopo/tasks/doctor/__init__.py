"""Check whether this machine can do the work."""
