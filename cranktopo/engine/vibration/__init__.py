"""Torsional vibration of the shaft: chain of disks, orders of torque, response over speed."""
