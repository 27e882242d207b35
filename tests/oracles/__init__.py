"""Slow, trusted reference computations that the tests compare the package against; nothing in the package imports them.

``impact``      one frictional impact, ball against ball or ball against cushion, to about 1e-12 of the incoming speed.
``tiny_steps``  a whole shot on an unbounded cloth by small fixed steps of the forces.

Both are derived from rigid-body mechanics alone and share no code, formula or constant with ``snooker_env.physics``.
"""
