"""Where do the numbers of a table lie? Columns (safe to freeze) of its arrays, which ``Table`` explains."""

NOSE_AXIS, NOSE_SIDE, NOSE_LEVEL, NOSE_LOW, NOSE_HIGH = range(5)
AXIS_X, AXIS_Y = 0.0, 1.0
"""Values of the column NOSE_AXIS: the coordinate that the nose bounds."""

JAW_X, JAW_Y, JAW_RADIUS, JAW_UX, JAW_UY, JAW_COS = range(6)

FALL_X, FALL_Y, FALL_RADIUS = range(3)
