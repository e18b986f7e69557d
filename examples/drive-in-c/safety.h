/* Torque, latched fault and watchdog. Section 8 of docs/protocol.md. */

#ifndef SAFETY_H
#define SAFETY_H

#include "drive.h"

void set_torque(struct drive *drive, float torque_nm);

/* Enters a state without torque. */
void rest(struct drive *drive, enum lashloop_state state);

/* Takes the torque away and enters Faulted; returns the fault, which is latched unless one is already. */
struct fault latch(struct drive *drive, uint8_t code, float value, float limit);

/* Latches a fault if the host has been silent for longer than the watchdog allows; returns whether it has. */
int check_watchdog(struct drive *drive);

#endif
