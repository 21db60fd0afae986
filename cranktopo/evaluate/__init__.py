"""Body-fitted evaluation: the independent judge."""
