"""Which class of tables plays which task? A dict by the name of the option ``task``."""

from .frame import Frames
from .matches import Matches
from .tables import Tables
from .visit import Visits

TABLES: dict[str, type[Tables]] = {"visit": Visits, "frame": Frames, "match": Matches}
