"""Filters and projections of a density field."""
