"""Body-fitted evaluation: tet10 finite elements on the exact solid, condensed to 6 x 6 stiffnesses."""
