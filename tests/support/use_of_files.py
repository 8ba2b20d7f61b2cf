"""What comes of one file, in few words; and what a worker does that reads one after the other."""

import os
import warnings
from contextlib import suppress
from pathlib import Path

import lostmotion as lm
from lostmotion.errors import LostMotionError
from lostmotion.files import apart, child
from tests.support.hostile_files import APART, FRAMES, mutant, odd_frame
from tests.support.hostile_plant import PLANT, USES, plant_mutant

LONGEST = 3000  # characters of one line
HURRY = 2  # s of work for a file in a reader without a process of its own; who takes longer has another try in one


def outcome(source, use=lm.read_loops):
    """Read it as a command would, with warnings as errors; `use` gives False where it has told of a refusal itself."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = use(source)
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
    if found is False:
        return "refused"
    return "TRACEBACK no record" if use is lm.read_loops and not found else "read"


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


def limited(more):
    """So many bytes of address space more than this process has now."""
    with suppress(ImportError):
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
        memory = pages * resource.getpagesize() + more
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def hurried(seconds):
    """So many further seconds of processor time, then this process is ended."""
    with suppress(ImportError):
        import resource

        used = resource.getrusage(resource.RUSAGE_SELF)
        most = int(used.ru_utime + used.ru_stime + seconds) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (most, resource.getrlimit(resource.RLIMIT_CPU)[1]))


def serve(asked, said, kind, seed, path, here, more):
    """Numbers of files come by one descriptor, what came of each goes out by another, until no more comes."""
    apart_here = kind in APART and here
    if apart_here:
        in_this_process()
    limited(more)
    errors = Errors(path.parent)
    for line in os.fdopen(asked):
        number = int(line)
        if apart_here:
            hurried(HURRY)
        if kind == FRAMES:
            came = outcome(odd_frame(number, seed))
        elif kind in PLANT:
            path.write_bytes(plant_mutant(kind, number, seed))
            came = outcome(path, USES[kind][1])
        else:
            path.write_bytes(mutant(kind, number, seed))
            came = outcome(path)
        stray = errors.taken()
        os.write(said, f"{came}{f' STRAY {stray!r}' if stray else ''}\n".encode())
