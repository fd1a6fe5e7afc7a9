"""All families by name."""
from deceiving import cornered, smooth  # noqa: F401: their families enter the table
from deceiving.drawing import FAMILIES  # noqa: F401
