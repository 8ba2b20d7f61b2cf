"""MATLAB files -> dotted path and value of each variable -> a table for each loop."""

from __future__ import annotations

from lostmotion.extras import need_extra
from lostmotion.files.apart import leaves_apart
from lostmotion.files.child import HDF5
from lostmotion.files.matlab_v5 import leaves_of_version_5
from lostmotion.files.structs import tables_of_structs
from lostmotion.files.table import Table
from lostmotion.files.undamaged import undamaged

MAT = b"MATLAB 5.0 MAT-file"  # written by save -v6 and -v7
MAT_HDF5 = b"MATLAB 7.3 MAT-file"


def load_mat(raw: bytes, source: str) -> dict[str, Table]:
    """Tables of a MAT file by the name of the loop; under "" where there is one.

    Parameters
    ----------
    raw : bytes
        Content of a file of version 5 (``save -v7`` or ``-v6``) or of version 7.3.
    source : str
        Name of the file, for messages.

    Raises
    ------
    DataError
        A damaged file, one without vectors, or one of version 7.3 where its reader is not installed.

    Notes
    -----
    The reader of version 7.3 is written in C, and changed bytes could crash it: it runs in a process of its own.
    """
    hdf5 = raw.startswith(MAT_HDF5)
    if hdf5:
        need_extra("matlab", "save it with save(.., '-v7')")
    with undamaged("a whole MAT file", source, "save it again"):
        leaves = leaves_apart(HDF5, raw) if hdf5 else leaves_of_version_5(raw)
    return tables_of_structs(leaves, source)
