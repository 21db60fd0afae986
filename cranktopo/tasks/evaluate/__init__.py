"""Evaluation of targets on the command line, and what a millimetre of each dimension is worth."""
