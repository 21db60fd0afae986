"""Accuracy and its cost in time: studies over finer and finer models, and choices from them."""
