"""Files of a design for other programs: solids, drawings and the reduced model of its shaft."""
