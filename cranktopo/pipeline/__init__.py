"""The stages in order, and the files that they leave: what a command runs."""
