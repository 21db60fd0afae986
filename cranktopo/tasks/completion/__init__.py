"""Completion of the command line by a shell."""
