"""``python -m lostmotion``.

Python itself imports from the working folder before this line is reached; the command ``lostmotion`` and
``python -P -m lostmotion`` do not. What is imported from here on comes from elsewhere.
"""

import sys
from pathlib import Path

if __name__ == "__main__":
    if not sys.flags.safe_path and Path(sys.path[0]) != Path(__file__).parents[1]:
        del sys.path[0]
    from lostmotion.cli import main

    main()
