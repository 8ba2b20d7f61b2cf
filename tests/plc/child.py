"""The ST machine as the child of `lostmotion demo-live --plc`: see lostmotion.live.child_plc for what is said.

``python -m tests.plc.child`` from the root of the repository.
"""

import json
import sys

import numpy as np

from tests.plc.machine import LIBRARY, DoesNotCompileError, Machine


def main():
    begin = json.loads(sys.stdin.readline())
    if not LIBRARY.exists():
        return say(error="no ST machine here: run `make plc`")
    try:
        machine = Machine(begin["st"])
    except DoesNotCompileError as error:
        return say(error=str(error))
    say(ready=True)
    for line in sys.stdin:
        asked = json.loads(line)
        row = np.array([[*asked["inputs"], *asked["parameters"]]])
        columns = [*begin["inputs"], *begin["parameters"]]
        outputs = machine.run([float(asked["cold"])], columns, row, begin["outputs"])
        say(outputs=outputs[0].tolist())
    return None


def say(**answer):
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
