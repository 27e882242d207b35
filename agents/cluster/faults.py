"""What can go wrong on a cluster, and how is it said in one line? Nothing here imports Ray."""

import socket

from commands.lifecycle import installs
from snooker_env.checks import refuse

ANSWER = 10.0
"""Seconds in which the head of a cluster has to answer."""


class ClusterError(Exception):
    """A cluster cannot play on: its text is one line that says why and what to do. What was played is kept."""


def split_address(address):
    """(host, port) of ``HOST:PORT``. Raises ValueError.

    Examples
    --------
    >>> from agents.cluster.faults import split_address
    >>> split_address("10.0.0.1:6379")
    ('10.0.0.1', 6379)
    """
    host, colon, port = address.rpartition(":")
    if not host or not colon or not port.isdecimal() or not 0 < int(port) < 2**16 or "/" in host:
        raise refuse("ray", address, "must be local, or HOST:PORT of the head of a Ray cluster that this machine is part of")
    return host, int(port)


def answers(address, seconds=ANSWER):
    """Whether anything takes connections at ``HOST:PORT``; None, or why not in words."""
    try:
        socket.create_connection(split_address(address), seconds).close()
    except OSError as error:
        return f"no answer in {seconds:.0f} s" if isinstance(error, TimeoutError) else error.strerror or str(error)
    return None


def of_part(cause, where=""):
    """The ``ClusterError`` for an error inside a part if it is one of the machine; None if it is the part's own."""
    here = f" on {where}" if where else ""
    if isinstance(cause, ClusterError):
        return cause
    if isinstance(cause, MemoryError):
        return out_of_memory(here)
    if isinstance(cause, ImportError):
        everywhere = f"install the same clone on every node ({installs('cluster')})"
        return ClusterError(f"a worker{here} cannot import {cause.name or cause}: {everywhere}")
    if isinstance(cause, OSError) and cause.errno in (28, 122):  # ENOSPC, EDQUOT
        return ClusterError(f"the disk of a worker{here} is full ({cause.filename or 'its temporary folder'}): free space there")
    return None


def out_of_memory(here=""):
    """The ``ClusterError`` for a worker that had no memory left."""
    return ClusterError(f"a worker{here} ran out of memory: give the node fewer workers (ray start --num-cpus) or more memory")
