"""The optimise run: the stages in order, their files and their page."""
