"""One folder for each thing that is done: its stage, its result, its text, its page, its command."""
