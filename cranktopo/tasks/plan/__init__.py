"""The physics plan: which effects are simulated, and why."""
