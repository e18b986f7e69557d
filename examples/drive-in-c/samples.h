/* Samples and torques. Section 7 of docs/protocol.md. */

#ifndef SAMPLES_H
#define SAMPLES_H

#include "drive.h"

/* Prepares a run with the values in force. Returns the index of the speed limit at which an encoder may be ambiguous
 * within one period, or PARAMETER_COUNT if there is none. */
int prepare_run(struct run *run, const double values[PARAMETER_COUNT]);

/* Answers an EncoderSample. */
void take_sample(struct drive *drive, const uint8_t *sample);

#endif
