"""`python -m cranktopo`: the command, where no script of it is on the path."""

from cranktopo.app.launch import main

if __name__ == "__main__":  # who walks all modules imports this one too
    main()
