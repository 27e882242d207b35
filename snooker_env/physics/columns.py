"""Where do the numbers of a table lie, and the constants? Indices, which are safe to freeze into a kernel."""

NOSE_AXIS, NOSE_SIDE, NOSE_LEVEL, NOSE_LOW, NOSE_HIGH = range(5)
AXIS_X, AXIS_Y = 0.0, 1.0  # values of the column NOSE_AXIS: the coordinate that the nose bounds

JAW_X, JAW_Y, JAW_RADIUS, JAW_UX, JAW_UY, JAW_COS = range(6)

FALL_X, FALL_Y, FALL_RADIUS = range(3)

# Places in ``Physics.pack()``: of balls and cloth, of balls that meet, of cushions; of P_E_T 0 where no ball flies.
P_R, P_M, P_G, P_MU_S, P_MU_R, P_SPIN, P_E_B, P_MU_BB_LEAST, P_MU_BB_EXTRA, P_MU_BB_FADE = range(10)
P_E_C, P_E_KNEE, P_E_POWER, P_MU_C, P_SIN, P_E_J, P_NAP, P_ROLL_DRAG, P_E_T = range(10, 19)
P_RAIL, P_JAW, P_BALLS = range(19, 22)  # where tables of rolling impacts begin behind these; 0: none
CONSTANTS = P_BALLS + 1
