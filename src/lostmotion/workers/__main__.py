"""A worker: see :mod:`lostmotion.workers.child`."""

from lostmotion.workers.child import main

if __name__ == "__main__":
    main()
