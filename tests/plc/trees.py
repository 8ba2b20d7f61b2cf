"""Digest of the tree of ST without its comments, by tree-sitter; with the Python of .venv-plc: `trees.py FILE ..`.

A tree with errors has the digest "error".
"""

import hashlib
import sys
from pathlib import Path

import tree_sitter
import tree_sitter_iec61131_3_st


def leaves(node):
    """Kinds of all nodes and text of those that hold no other, but for comments."""
    if node.type == "comment":
        return
    yield node.type
    if not node.children:
        yield node.text.decode()
    for inner in node.children:
        yield from leaves(inner)


def digest(path):
    parser = tree_sitter.Parser(tree_sitter.Language(tree_sitter_iec61131_3_st.language()))
    tree = parser.parse(path.read_bytes())
    if tree.root_node.has_error:
        return "error"
    return hashlib.sha256("\0".join(leaves(tree.root_node)).encode()).hexdigest()


if __name__ == "__main__":
    for name in sys.argv[1:]:
        sys.stdout.write(f"{digest(Path(name))}\n")
