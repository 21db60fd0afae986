"""The oil film of the plain bearings: least thickness and largest pressure over the cycle."""
