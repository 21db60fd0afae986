"""Optimisers for few and for many variables, and what they tell of an optimum."""
