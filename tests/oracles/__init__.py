"""Slow, trusted reference computations that the tests compare the package against; nothing in the package
imports them.

``ball_ball``        one frictional impact of two balls, to about 1e-12 of the incoming speed.
``ball_cushion``     one frictional impact of a ball on a cushion, to about 1e-12.
``march``            how the float oracles pass an impact's changes of slip and stick, and their vectors.
``moreau``           the same impacts by another method, to about 1e-9; and of a ball that comes down on another.
``flight_3d``        a whole shot, with balls that fly or do not, on a table or unbounded cloth, by small fixed steps of the forces.
``cue_clearance``    how near a cue comes to rails and balls, by spheres along its axis.
``pocket_3d``        one ball in a pocket in three dimensions, by small fixed steps of the forces.
``frame_oracle``     whole frames judged by the rules of snooker, stroke by stroke; a command. Its parts begin with the same name.

The oracles are derived from rigid-body mechanics alone and share no code, formula or constant with
``snooker_env.physics``.

Model of an impact. It is instantaneous; the accumulated normal impulse ``P`` takes the place of time. Every
contact obeys Coulomb's law, and at zero slip the law is decided by the forces: the contact sticks if the
friction that holds it is within the limit, else it slips in the direction the other forces drive it. Cloth
and ball obey ``N >= 0``, ``v_z >= 0``, ``N v_z = 0``. Restitution is energetic (Stronge 2000, *Impact
Mechanics*): the normal force gives back ``e^2`` of the work it took in.

Units are SI. Table frame: right-handed, z up; ``v`` [m/s] and ``w`` [rad/s] are arrays of shape (3,). R
(radius) only scales ``w`` and M (mass) only scales the impulse, which is not returned: both cancel but are
parameters, as of every model of the package.
"""
