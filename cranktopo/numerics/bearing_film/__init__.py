"""Oil film of a cylindrical journal bearing under a load that changes: pressure, mobility, orbit."""
