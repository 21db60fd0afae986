"""Shape optimisation: the dimensions of a web that can be made, for a goal and limits."""
