"""Pipeline: what each command does, as one function: the stages in order, and the files that they leave."""
