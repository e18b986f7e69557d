/* The messages of the drive. Section 4 of docs/protocol.md. */

#ifndef MESSAGES_H
#define MESSAGES_H

#include "drive.h"

/* Adds the number of the request, if the kind has one. */
void send_body(struct drive *drive, uint8_t *body, size_t len);

/* Answers to the request. */
void send_identity(struct drive *drive, uint32_t session);
void send_result(struct drive *drive, enum lashloop_outcome outcome);
void send_line_report(struct drive *drive);
void answer_parameter(struct drive *drive, uint8_t index, enum lashloop_outcome outcome);
/* Each of these refuses an index that nothing has. */
void describe_parameter(struct drive *drive, uint8_t index);
void describe_law(struct drive *drive, uint8_t index);
void describe_signal(struct drive *drive, uint8_t index);
void describe_choice(struct drive *drive, uint8_t parameter, uint8_t choice);

void send_fault(struct drive *drive, const struct fault *fault);
/* The subscribed signals, in ascending order of index. */
void send_telemetry(struct drive *drive, uint16_t sequence, const float signals[SIGNAL_COUNT]);

#endif
