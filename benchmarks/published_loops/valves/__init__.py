"""Valve models of the papers, one a file."""

from published_loops.valves.choudhury import Choudhury
from published_loops.valves.dead_zone import DeadZone
from published_loops.valves.he import Chen, He
from published_loops.valves.kano import Kano
from published_loops.valves.karnopp import Karnopp
from published_loops.valves.lag import Behind
from published_loops.valves.lugre import LuGre
from published_loops.valves.play import Play
from published_loops.valves.sound import Sound
from published_loops.valves.stenman import Stenman
from published_loops.valves.valve import Stem, Valve

__all__ = [
    "Behind",
    "Chen",
    "Choudhury",
    "DeadZone",
    "He",
    "Kano",
    "Karnopp",
    "LuGre",
    "Play",
    "Sound",
    "Stem",
    "Stenman",
    "Valve",
]
