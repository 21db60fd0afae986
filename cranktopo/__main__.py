"""`python -m cranktopo`: the command, where no script of it is on the path."""

from cranktopo.app.launch import main

main()
