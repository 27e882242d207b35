"""What are the columns of a stroke? A row of five numbers in SI."""

from math import inf

from ..tasks.box_actions import MAX_SPEED, MIN_SPEED, STEEPEST

(SPEED, SIDE, TOP, AIM, ELEVATION) = range(5)
"""Cue speed [m/s]; tip offset over R to the right and up; direction in which the cue ball leaves the tip [rad] (the cue
itself points aside by the squirt of the side; under a raised cue the cloth then turns the ball); elevation of the cue [rad]."""
COLUMNS = 5
NAMES = ("speed", "side", "top", "aim", "elevation")
FARTHEST = 0.5  # largest tip offset over R: the miscue limit, and the end of the scale of an action
LEAST, MOST = (MIN_SPEED, -FARTHEST, -FARTHEST, -inf, 0.0), (MAX_SPEED, FARTHEST, FARTHEST, inf, STEEPEST)
"""The bounds of each column."""
