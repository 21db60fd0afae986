"""What is wanted of a web: a goal and limits, in words that every optimiser understands."""
