"""The command line: finds the commands of the tasks, and turns errors into exit codes."""
