"""Matrix-free finite elements on a structured grid, in JAX."""
