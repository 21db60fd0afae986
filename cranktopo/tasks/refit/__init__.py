"""The parametric web fitted to an extracted body."""
