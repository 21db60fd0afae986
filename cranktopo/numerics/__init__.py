"""Numerical methods for any part: elements, kernels, filters, optimisers, surfaces."""
