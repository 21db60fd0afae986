"""What accuracy costs in time: studies over finer and finer models, their Pareto front, choices from it."""
