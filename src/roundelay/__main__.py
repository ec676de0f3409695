"""The program: ``roundelay`` or ``python -m roundelay``."""

import sys


def main() -> None:
    """Run the command line; interrupted, even while it is loaded, end without a traceback."""
    try:
        from roundelay.cli import app

        app()
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
