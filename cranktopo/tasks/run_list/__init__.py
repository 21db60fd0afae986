"""Runs under a folder: list, show, clean up."""
