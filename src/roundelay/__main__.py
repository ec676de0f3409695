"""The program: ``roundelay`` or ``python -m roundelay``."""

import sys

from roundelay.base.signals import end_at_once, end_by_default, end_in_order

__all__ = ["main"]


def main() -> None:
    """Run the command line; told to end, even while it is loaded, do so without a traceback."""
    end_at_once()
    try:
        from roundelay.cli import app

        end_in_order()
        app()
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        end_by_default()


if __name__ == "__main__":
    main()
