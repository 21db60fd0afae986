"""Oil drillings of a throw: table, body, checks, mass, element sizes, walls that a fit keeps."""
