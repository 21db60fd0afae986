"""The independent judge: tet10 finite elements on the body-fitted solid, condensed to 6 x 6 stiffnesses."""
