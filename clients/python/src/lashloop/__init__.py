"""Host and drive of the Lashloop hardware-in-the-loop bench, written from `docs/protocol.md`.

| module | is |
|---|---|
| `messages`, `enums`, `layout` | messages, lists of values, types of fields |
| `frames`, `decoder` | frames: COBS, CRC, resynchronisation |
| `link` | serial ports and pseudo-terminals |
| `host` | the host's side of the protocol |
| `drive` | a drive: state machine without I/O, and the loop that runs it on a link |
| `control` | control laws of a drive |
"""
