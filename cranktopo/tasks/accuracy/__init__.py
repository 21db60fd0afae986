"""What accuracy costs in time: studies over finer and finer models, and choices from them."""
