"""The kit of all commands: options, types of arguments, streams, verbosity, completion."""
