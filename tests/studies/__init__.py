"""Studies that tests and benchmarks share: true values, bounds and errors on many designs."""
