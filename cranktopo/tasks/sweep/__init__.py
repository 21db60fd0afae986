"""Many points of a design space on Dask: table, Pareto front and page."""
