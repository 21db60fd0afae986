"""The engine that loads the throw: kinematics, gas, forces, load cases, bearings."""
