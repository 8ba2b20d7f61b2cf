"""``python -m lostmotion``."""

from lostmotion.cli import main

if __name__ == "__main__":
    main()
