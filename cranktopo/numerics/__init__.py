"""Numerical methods that know no crank: elements, kernels, filters, optimisers, surfaces."""
