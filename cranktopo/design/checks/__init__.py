"""Consistency of a scene beyond single values."""
