"""What accuracy costs in time: ladders of finer and finer models, their frontier, and choices from it."""
