"""The parts of a crank throw, one file each: table, rules, section, solid, signed distance, drawing."""
