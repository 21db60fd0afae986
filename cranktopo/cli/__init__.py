"""Command line: one file per command, a thin skin over the stages."""
