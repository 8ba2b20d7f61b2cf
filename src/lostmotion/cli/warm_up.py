"""``python -m lostmotion.cli.warm_up``: compile and cache every kernel once, before parallel workers do."""

import lostmotion as lm

if __name__ == "__main__":
    loop = lm.routine_operation(600, seed=0)
    lm.identify(loop.command, loop.measured, 0.1)
    recursive = lm.RecursiveML(1, 0, 1, forgetting=0.999, start_samples=200)
    recursive.run(loop.command, loop.measured)
