"""A Python without POSIX: with this folder on PYTHONPATH every process, and all that it starts, runs like on Windows.

Modules of lostmotion alone see another platform: ``sys.platform`` is "win32", what only POSIX has of ``os``, ``signal``
and ``select`` is not there, nor is /proc; ``fcntl``, ``resource``, ``pwd`` and ``grp`` cannot be imported, ``msvcrt``
can. The standard library and packages keep their own platform: other builds of them are tested there by their authors.
For all of Python: no fork, text files in cp1252 with CRLF, and files as on NTFS: one that is open, or was just written,
is not replaced or removed, a rename replaces nothing, and names of devices or with one of ``<>:"|?*`` are refused.

Not shown by it: compiled packages, SQLite's own files, drives and UNC paths, the console, time zones, job objects.
"""

import builtins
import errno
import fcntl
import io
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import types
from contextlib import suppress
from pathlib import Path

GONE_MODULES = {"fcntl", "resource", "pwd", "grp", "termios", "posix", "pty", "syslog"}
GONE_OF_OS = """
    fork forkpty register_at_fork kill killpg getpgid getpgrp setpgid setsid getsid getuid geteuid getgid getegid setuid
    setgid getgroups nice uname getloadavg sched_getaffinity sched_setaffinity pathconf fpathconf statvfs mkfifo mknod
    chown fchown fchmod chroot sysconf wait waitpid wait3 wait4 WNOHANG O_NOFOLLOW O_NONBLOCK O_TMPFILE O_DIRECTORY
    O_CLOEXEC O_SYNC O_DSYNC openpty ttyname sendfile getxattr setxattr memfd_create pread pwrite
"""
GONE_OF_SIGNAL = """
    SIGKILL SIGHUP SIGUSR1 SIGUSR2 SIGPIPE SIGALRM SIGCHLD SIGTTIN SIGTTOU SIGTSTP SIGSTOP SIGCONT SIGQUIT SIGXCPU alarm
    setitimer pthread_sigmask sigwait sigtimedwait pause set_wakeup_fd
"""
NAMES = re.compile(r'[<>:"|?*\x00-\x1f]|[ .]$|^(con|prn|aux|nul|com\d|lpt\d)\s*(\.|$)', re.IGNORECASE)
SOURCE = f"{os.sep}src{os.sep}lostmotion{os.sep}"
TRIED = set()  # files that were in use when they were to be replaced first
flock, LOCK_EX, LOCK_NB = fcntl.flock, fcntl.LOCK_EX, fcntl.LOCK_NB
CALLS = ("open", "mkdir", "replace", "rename", "unlink", "listdir", "readlink")
real = types.SimpleNamespace(io_open=io.open, **{name: getattr(os, name) for name in CALLS})


class Other(types.ModuleType):
    """A module as lostmotion sees it."""

    def __init__(self, module, gone="", **own):
        super().__init__(module.__name__)
        self.__dict__.update(own, _module=module, _gone=gone.split(), __file__=None)

    def __getattr__(self, name):
        if name in self.__dict__["_gone"]:
            raise AttributeError(f"module {self._module.__name__!r} has no attribute {name!r} on Windows")
        return getattr(self.__dict__["_module"], name)

    def __setattr__(self, name, value):
        setattr(self.__dict__["_module"], name, value)


def refuse(number, path):
    raise OSError(number, os.strerror(number), os.fspath(path) if isinstance(path, os.PathLike) else path)


def need_name(path):
    """Raise where Windows makes no file or folder of this name."""
    if not isinstance(path, int) and NAMES.search(Path(os.fsdecode(path)).name):
        refuse(errno.EINVAL, path)


def in_use(path):
    """Whether this user's processes have a file open or mapped."""
    path = os.path.realpath(os.fsdecode(path))
    with suppress(OSError), real.io_open("/proc/self/maps", encoding="utf-8", errors="replace") as maps:
        if any(line.rstrip().endswith(path) for line in maps):
            return True
    for process in real.listdir("/proc"):
        with suppress(OSError):
            for number in real.listdir(f"/proc/{process}/fd") if process.isdigit() else ():
                with suppress(OSError):
                    if real.readlink(f"/proc/{process}/fd/{number}") == path:
                        return True
    return False


def ours(frame):
    """Whether lostmotion called, by the standard library at most."""
    while frame is not None and "site-packages" not in frame.f_code.co_filename:
        if SOURCE in frame.f_code.co_filename:
            return True
        frame = frame.f_back
    return False


def need_closed(path):
    if in_use(path):
        refuse(errno.EACCES, path)


def opened(path, flags, mode=0o777, **more):
    """``os.open`` of lostmotion: no folder, no new file of a bad name."""
    if Path(path).is_dir():
        refuse(errno.EACCES, path)
    if flags & os.O_CREAT:
        need_name(path)
    return real.open(path, flags, mode, **more)


def io_opened(file, mode="r", buffering=-1, encoding=None, errors=None, newline=None, *more, **named):
    if not isinstance(file, int):
        if os.fsdecode(file).startswith("/proc/") and ours(sys._getframe(1)):
            refuse(errno.ENOENT, file)
        if set(mode) & set("wax"):
            need_name(file)
    if "b" not in mode:
        encoding = "cp1252" if encoding in (None, "locale") else encoding
        newline = "\r\n" if newline is None and set(mode) & set("wax") else newline
    return real.io_open(file, mode, buffering, encoding, errors, newline, *more, **named)


def replaced(source, target, **more):
    need_name(target)
    need_closed(source)
    if os.path.lexists(target):
        if (once := os.fsdecode(target)) not in TRIED:  # something searches the new file for viruses
            TRIED.add(once)
            refuse(errno.EACCES, target)
        need_closed(target)
    return real.replace(source, target, **more)


def renamed(source, target, **more):
    need_name(target)
    if os.path.lexists(target):
        refuse(errno.EEXIST, target)
    for path in Path(source).rglob("*") if Path(source).is_dir() else [source]:
        need_closed(path)
    return real.rename(source, target, **more)


def removed(path, **more):
    if not more.get("dir_fd"):
        need_closed(path)
    return real.unlink(path, **more)


def made(path, mode=0o777, **more):
    need_name(path)
    return real.mkdir(path, mode, **more)


def locking(number, mode, count):
    """``msvcrt.locking`` without waiting."""
    try:
        flock(number, LOCK_EX | LOCK_NB)
    except BlockingIOError:
        refuse(errno.EACCES, number)


def selected(*given):
    """Windows selects sockets only."""
    refuse(errno.ENOTSOCK, "select")


MSVCRT = types.ModuleType("msvcrt")
MSVCRT.locking, MSVCRT.LK_NBLCK = locking, 2
OURS = {
    "os": Other(os, GONE_OF_OS, name="nt", open=opened),
    "sys": Other(sys, platform="win32"),
    "signal": Other(signal, GONE_OF_SIGNAL),
    "select": Other(select, "poll epoll", select=selected),
    "subprocess": Other(subprocess, CREATE_NEW_PROCESS_GROUP=0),  # a flag that POSIX refuses
    "msvcrt": MSVCRT,
}
imported = builtins.__import__


def seen(name, globals_=None, locals_=None, fromlist=(), level=0):
    if not level and (name in OURS or name in GONE_MODULES) and SOURCE in str((globals_ or {}).get("__file__")):
        if name in GONE_MODULES:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return OURS[name]
    return imported(name, globals_, locals_, fromlist, level)


builtins.__import__ = seen
builtins.open = io.open = io_opened
os.replace, os.rename, os.unlink, os.remove, os.mkdir = replaced, renamed, removed, removed, made
shutil._use_fd_functions = False
del os.fork, os.forkpty
