"""Files of a design's exact solid and its workshop drawing."""
