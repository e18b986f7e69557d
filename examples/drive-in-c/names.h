/* Names of values that the drive sends. Section 10 of docs/protocol.md. */

#ifndef NAMES_H
#define NAMES_H

#include <stdint.h>

/* Name of a value of a parameter with choices, or of one of the drive's lists; 0 if the drive has no such value. */
const char *name_of(uint8_t parameter, uint8_t choice);

#endif
