"""One module a command of the command line; heavy imports happen when a command runs."""
