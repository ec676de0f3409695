"""The program: ``roundelay`` or ``python -m roundelay``."""

import os
import sys


def main() -> None:
    """Run the command line; interrupted, even while it is loaded, end without a traceback."""
    # The matrices here are small: threads of the linear algebra would only get in each
    # other's way. Set before numpy is loaded, unless the user has.
    for threads in ("OPENBLAS", "MKL", "OMP"):
        os.environ.setdefault(f"{threads}_NUM_THREADS", "1")
    try:
        from roundelay.cli import app

        app()
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
