"""`python -m anisogran` is the command line."""

from anisogran.cli import main

main()
