"""A balancer shaft as a part: statics, bearings, deflection, fatigue."""
