"""Where do the numbers of a table lie? Columns of the rows of ``Table.noses``, ``Table.jaws`` and ``Table.falls``, which state their
meaning.

They are indices, not tunables: freezing them into a kernel is safe. Kernels read single numbers by them; a row, or a tuple of its
numbers, is not made (see ``detection.may_meet``).
"""

NOSE_AXIS, NOSE_SIDE, NOSE_LEVEL, NOSE_LOW, NOSE_HIGH = range(5)
AXIS_X, AXIS_Y = 0.0, 1.0
"""What NOSE_AXIS says: the coordinate that the nose bounds."""

JAW_X, JAW_Y, JAW_RADIUS, JAW_UX, JAW_UY, JAW_COS = range(6)

FALL_X, FALL_Y, FALL_RADIUS = range(3)
