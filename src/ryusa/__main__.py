"""`python -m ryusa`: the command line, where the `ryusa` command is not on the path."""

from ryusa.cli import main

if __name__ == "__main__":
    main()
