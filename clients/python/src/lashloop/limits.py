"""The numbers of the protocol that do not depend on a message: versions, and sizes of frames, drives and lists."""

from __future__ import annotations

PROTOCOL_VERSION = 1
"""Host and drive must have the same one."""
MINOR_VERSION = 0
"""Additions to the version. It may differ: each side ignores what it does not know."""

MAX_FRAME = 64
"""Longest frame in bytes, COBS code and delimiter included."""
OVERHEAD = 6
"""Bytes of a frame beyond its body."""
MAX_BODY = MAX_FRAME - OVERHEAD
"""Longest body in bytes."""

MAX_LAWS = 16
MAX_SIGNALS = 32
MAX_PARAMETERS = 240
"""Most parameters of a drive. Larger indices in `DescribeChoice` stand for the lists below."""
MAX_TELEMETRY_VALUES = (MAX_BODY - 3) // 4
"""Most values of one telemetry: what the longest body holds besides kind and sequence."""

FAULT_NAMES = 255
"""`DescribeChoice` with this parameter names a fault code of the drive."""
OUTCOME_NAMES = 254
"""`DescribeChoice` with this parameter names an outcome of the drive."""
STATE_NAMES = 253
"""`DescribeChoice` with this parameter names a state of the drive."""
FLAG_NAMES = 252
"""`DescribeChoice` with this parameter names a torque flag of the drive, by its mask."""
KIND_NAMES = 251
"""`DescribeChoice` with this parameter names a kind of message that the drive takes or sends."""
