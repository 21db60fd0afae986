"""Matrix-free finite elements on the structured grid, in JAX."""
