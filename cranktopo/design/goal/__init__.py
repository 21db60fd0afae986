"""Goals of a web: a quantity and limits, in words that every optimiser understands."""
