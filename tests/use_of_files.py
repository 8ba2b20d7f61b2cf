"""What comes of one file, in few words; and a worker that reads one after the other, each told before it is tried."""

import os
import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

import lostmotion as lm
from lostmotion.errors import LostMotionError
from lostmotion.files import apart, child
from tests.hostile_files import APART, FRAMES, mutant, odd_frame

LONGEST = 3000  # characters of one line


def outcome(source):
    """Read it as a command would, with warnings as errors."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            records = lm.read_loops(source)
    except LostMotionError as error:
        said = str(error)
        worse = (
            "MANY LINES " if set(said) & set("\n\r\v\f\x1b\x85\u2028") else "LONG LINE " if len(said) > LONGEST else ""
        )
        return f"{worse}refused" + (f" {said[:150]!r}" if worse else "")
    except MemoryError:
        return "MEMORY"
    except BaseException as error:  # noqa: BLE001  it is what is sought; a panic of Rust is no Exception
        where = error.__traceback__
        while (
            where is not None
            and where.tb_next is not None
            and "lostmotion" in where.tb_next.tb_frame.f_code.co_filename
        ):
            where = where.tb_next
        place = "" if where is None else f"{Path(where.tb_frame.f_code.co_filename).name}:{where.tb_lineno}"
        return f"TRACEBACK {type(error).__name__} {place} {str(error)[:80]!r}"
    return "read" if records else "TRACEBACK no record"


class Errors:
    """What libraries write to standard error by themselves."""

    def __init__(self, folder):
        self._file = (Path(folder) / "stderr").open("w+b", buffering=0)
        os.dup2(self._file.fileno(), 2)

    def taken(self):
        size = os.fstat(self._file.fileno()).st_size
        self._file.seek(0)
        said = self._file.read(200).decode("utf-8", "replace") if size else ""
        os.ftruncate(self._file.fileno(), 0)
        os.lseek(self._file.fileno(), 0, os.SEEK_SET)
        return said


def in_this_process():
    """Readers without the process of their own, a hundred times faster; a crash ends the worker instead."""
    apart._answer = lambda kind, raw, size: child.answer(kind, raw)


def limited(memory):
    with suppress(ImportError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def main(kind, begin, stop, seed, memory, how="here"):
    if kind in APART and how == "here":
        in_this_process()
    limited(int(memory))
    _tell("-1 ready\n")
    with tempfile.TemporaryDirectory() as folder:
        path, errors = Path(folder) / "FIC-101.dat", Errors(folder)
        for number in range(int(begin), int(stop)):
            if kind == FRAMES:
                source = odd_frame(number, int(seed))
            else:
                path.write_bytes(mutant(kind, number, int(seed)))
                source = path
            _tell(f"{number} ")
            said = outcome(source)
            stray = errors.taken()
            _tell(f"{said}{f' STRAY {stray!r}' if stray else ''}\n")


def _tell(text):
    sys.stdout.write(text)
    sys.stdout.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
