"""Host and drive of the Lashloop hardware-in-the-loop bench, written from `docs/protocol.md`.

| module | is |
|---|---|
| `messages`, `vocabulary`, `layout` | what passes between host and drive |
| `frames`, `decoder` | how it passes: COBS, CRC, resynchronisation |
| `lines` | serial ports and pseudo-terminals |
| `host` | the host's side of a conversation |
| `drive` | a drive: state machine without I/O, and what runs it on a line |
| `control` | control laws, the plug-in of a drive |
"""
