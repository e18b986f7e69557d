#include "messages.h"

#include "names.h"

#define BOARD "c-example"
#define CAPABILITIES LASHLOOP_CAPABILITIES_DEVICE_TIME

#define LONGEST_VALUES (LASHLOOP_MAX_TELEMETRY_VALUES * LASHLOOP_TELEMETRY_VALUES_ELEMENT_LEN)
_Static_assert(LASHLOOP_TELEMETRY_VALUES_OFFSET + LONGEST_VALUES <= LASHLOOP_TELEMETRY_BODY_LEN,
               "a body holds the most values that a host may subscribe to");

void send_body(struct drive *drive, uint8_t *body, size_t len)
{
    uint8_t frame[LASHLOOP_MAX_FRAME];
    if (LASHLOOP_HAS_NUMBER(body[0]))
        body[LASHLOOP_NUMBER_OFFSET] = drive->request.number;
    drive->board->send(frame, frame_of(body, len, frame));
}

/* Adds the device time, which is the optional last field. */
static void send_timed(struct drive *drive, uint8_t *body, size_t shortest_len)
{
    if (!(CAPABILITIES & LASHLOOP_CAPABILITIES_DEVICE_TIME)) {
        send_body(drive, body, shortest_len);
        return;
    }
    put_bits(body + shortest_len, (uint32_t)(drive->board->now_ns() / 1000), LASHLOOP_IDENTITY_DEVICE_TIME_US_LEN);
    send_body(drive, body, shortest_len + LASHLOOP_IDENTITY_DEVICE_TIME_US_LEN);
}

/* Texts are padded with zeros, and not terminated when they fill their field. */
static void put_text(uint8_t *at, const char *text, size_t len)
{
    for (size_t i = 0; i < len; i++)
        at[i] = *text ? (uint8_t)*text++ : 0;
}

static void put_value(uint8_t *at, int is_float, double value)
{
    at[0] = is_float ? LASHLOOP_PARAMETER_TYPE_F32 : LASHLOOP_PARAMETER_TYPE_U32;
    if (is_float)
        put_f32(at + 1, (float)value);
    else
        put_bits(at + 1, (uint32_t)value, 4);
}

void send_result(struct drive *drive, enum lashloop_outcome outcome)
{
    uint8_t body[LASHLOOP_COMMAND_RESULT_BODY_LEN] = { LASHLOOP_COMMAND_RESULT_KIND };
    body[LASHLOOP_COMMAND_RESULT_REQUEST_OFFSET] = drive->request.kind;
    body[LASHLOOP_COMMAND_RESULT_OUTCOME_OFFSET] = (uint8_t)outcome;
    body[LASHLOOP_COMMAND_RESULT_STATE_OFFSET] = (uint8_t)drive->state;
    put_bits(body + LASHLOOP_COMMAND_RESULT_DETAIL_OFFSET, drive->request.detail, 4);
    send_timed(drive, body, LASHLOOP_COMMAND_RESULT_SHORTEST_BODY_LEN);
}

void send_fault(struct drive *drive, const struct fault *fault)
{
    uint8_t body[LASHLOOP_FAULT_REPORT_BODY_LEN] = { LASHLOOP_FAULT_REPORT_KIND };
    body[LASHLOOP_FAULT_REPORT_CODE_OFFSET] = fault->code;
    put_bits(body + LASHLOOP_FAULT_REPORT_SEQUENCE_OFFSET, fault->sequence, 2);
    put_f32(body + LASHLOOP_FAULT_REPORT_VALUE_OFFSET, fault->value);
    put_f32(body + LASHLOOP_FAULT_REPORT_LIMIT_OFFSET, fault->limit);
    send_timed(drive, body, LASHLOOP_FAULT_REPORT_SHORTEST_BODY_LEN);
}

void send_identity(struct drive *drive, uint32_t session)
{
    uint8_t body[LASHLOOP_IDENTITY_BODY_LEN] = { LASHLOOP_IDENTITY_KIND };
    body[LASHLOOP_IDENTITY_PROTOCOL_VERSION_OFFSET] = LASHLOOP_PROTOCOL_VERSION;
    body[LASHLOOP_IDENTITY_MINOR_VERSION_OFFSET] = LASHLOOP_MINOR_VERSION;
    put_bits(body + LASHLOOP_IDENTITY_SESSION_OFFSET, session, 4);
    body[LASHLOOP_IDENTITY_FIRMWARE_OFFSET] = 1; /* 1.0.0; the build is unknown */
    body[LASHLOOP_IDENTITY_DIRTY_OFFSET] = 1;
    body[LASHLOOP_IDENTITY_STATE_OFFSET] = (uint8_t)drive->state;
    put_text(body + LASHLOOP_IDENTITY_BOARD_OFFSET, BOARD, LASHLOOP_IDENTITY_BOARD_LEN);
    put_bits(body + LASHLOOP_IDENTITY_PERIOD_US_OFFSET, (uint32_t)drive->values[PERIOD_US], 4);
    put_bits(body + LASHLOOP_IDENTITY_MOTOR_COUNTS_PER_REV_OFFSET, (uint32_t)drive->values[MOTOR_COUNTS_PER_REV], 4);
    put_bits(body + LASHLOOP_IDENTITY_LOAD_COUNTS_PER_REV_OFFSET, (uint32_t)drive->values[LOAD_COUNTS_PER_REV], 4);
    body[LASHLOOP_IDENTITY_LAW_COUNT_OFFSET] = 1;
    body[LASHLOOP_IDENTITY_SIGNAL_COUNT_OFFSET] = SIGNAL_COUNT;
    body[LASHLOOP_IDENTITY_PARAMETER_COUNT_OFFSET] = PARAMETER_COUNT;
    body[LASHLOOP_IDENTITY_CAPABILITIES_OFFSET] = CAPABILITIES;
    send_timed(drive, body, LASHLOOP_IDENTITY_SHORTEST_BODY_LEN);
}

void send_line_report(struct drive *drive)
{
    const struct counters *now = &drive->counters, *before = &drive->counters_at_start;
    uint8_t body[LASHLOOP_LINE_REPORT_BODY_LEN] = { LASHLOOP_LINE_REPORT_KIND };
    put_bits(body + LASHLOOP_LINE_REPORT_MESSAGES_OFFSET, now->messages - before->messages, 4);
    put_bits(body + LASHLOOP_LINE_REPORT_DAMAGED_OFFSET, now->damaged - before->damaged, 4);
    put_bits(body + LASHLOOP_LINE_REPORT_REFUSED_OFFSET, now->refused - before->refused, 4);
    send_timed(drive, body, LASHLOOP_LINE_REPORT_SHORTEST_BODY_LEN);
}

void answer_parameter(struct drive *drive, uint8_t index, enum lashloop_outcome outcome)
{
    uint8_t body[LASHLOOP_PARAMETER_REPORT_BODY_LEN] = { LASHLOOP_PARAMETER_REPORT_KIND };
    int is_known = index < PARAMETER_COUNT;
    body[LASHLOOP_PARAMETER_REPORT_INDEX_OFFSET] = index;
    body[LASHLOOP_PARAMETER_REPORT_OUTCOME_OFFSET] = (uint8_t)outcome;
    put_value(body + LASHLOOP_PARAMETER_REPORT_VALUE_OFFSET, is_known && PARAMETERS[index].is_float,
              is_known ? drive->values[index] : 0);
    body[LASHLOOP_PARAMETER_REPORT_STATE_OFFSET] = (uint8_t)drive->state;
    put_bits(body + LASHLOOP_PARAMETER_REPORT_DETAIL_OFFSET, drive->request.detail, 4);
    send_timed(drive, body, LASHLOOP_PARAMETER_REPORT_SHORTEST_BODY_LEN);
}

void describe_parameter(struct drive *drive, uint8_t index)
{
    if (index >= PARAMETER_COUNT) {
        answer_parameter(drive, index, LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        return;
    }
    const struct parameter *parameter = &PARAMETERS[index];
    uint8_t body[LASHLOOP_PARAMETER_DESCRIPTION_BODY_LEN] = { LASHLOOP_PARAMETER_DESCRIPTION_KIND };
    body[LASHLOOP_PARAMETER_DESCRIPTION_INDEX_OFFSET] = index;
    body[LASHLOOP_PARAMETER_DESCRIPTION_FLAGS_OFFSET] = parameter->flags;
    put_bits(body + LASHLOOP_PARAMETER_DESCRIPTION_LAWS_OFFSET, 1, 2); /* of law 0 */
    put_value(body + LASHLOOP_PARAMETER_DESCRIPTION_DEFAULT_OFFSET, parameter->is_float, parameter->initial);
    put_value(body + LASHLOOP_PARAMETER_DESCRIPTION_MIN_OFFSET, parameter->is_float, parameter->min);
    put_value(body + LASHLOOP_PARAMETER_DESCRIPTION_MAX_OFFSET, parameter->is_float, parameter->max);
    put_text(body + LASHLOOP_PARAMETER_DESCRIPTION_NAME_OFFSET, parameter->name, LASHLOOP_PARAMETER_DESCRIPTION_NAME_LEN);
    put_text(body + LASHLOOP_PARAMETER_DESCRIPTION_UNIT_OFFSET, parameter->unit, LASHLOOP_PARAMETER_DESCRIPTION_UNIT_LEN);
    send_body(drive, body, sizeof body);
}

void describe_law(struct drive *drive, uint8_t index)
{
    if (index > 0) {
        send_result(drive, LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        return;
    }
    uint8_t body[LASHLOOP_LAW_DESCRIPTION_BODY_LEN] = { LASHLOOP_LAW_DESCRIPTION_KIND };
    body[LASHLOOP_LAW_DESCRIPTION_INDEX_OFFSET] = index;
    put_text(body + LASHLOOP_LAW_DESCRIPTION_NAME_OFFSET, LAW_NAME, LASHLOOP_LAW_DESCRIPTION_NAME_LEN);
    send_body(drive, body, sizeof body);
}

void describe_signal(struct drive *drive, uint8_t index)
{
    if (index >= SIGNAL_COUNT) {
        send_result(drive, LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        return;
    }
    uint8_t body[LASHLOOP_SIGNAL_DESCRIPTION_BODY_LEN] = { LASHLOOP_SIGNAL_DESCRIPTION_KIND };
    body[LASHLOOP_SIGNAL_DESCRIPTION_INDEX_OFFSET] = index;
    put_bits(body + LASHLOOP_SIGNAL_DESCRIPTION_LAWS_OFFSET, 1, 2);
    put_text(body + LASHLOOP_SIGNAL_DESCRIPTION_NAME_OFFSET, SIGNALS[index].name, LASHLOOP_SIGNAL_DESCRIPTION_NAME_LEN);
    put_text(body + LASHLOOP_SIGNAL_DESCRIPTION_UNIT_OFFSET, SIGNALS[index].unit, LASHLOOP_SIGNAL_DESCRIPTION_UNIT_LEN);
    send_body(drive, body, sizeof body);
}

void describe_choice(struct drive *drive, uint8_t parameter, uint8_t choice)
{
    const char *name = name_of(parameter, choice);
    if (!name) {
        send_result(drive, LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        return;
    }
    uint8_t body[LASHLOOP_CHOICE_DESCRIPTION_BODY_LEN] = { LASHLOOP_CHOICE_DESCRIPTION_KIND };
    body[LASHLOOP_CHOICE_DESCRIPTION_PARAMETER_OFFSET] = parameter;
    body[LASHLOOP_CHOICE_DESCRIPTION_CHOICE_OFFSET] = choice;
    put_text(body + LASHLOOP_CHOICE_DESCRIPTION_NAME_OFFSET, name, LASHLOOP_CHOICE_DESCRIPTION_NAME_LEN);
    send_body(drive, body, sizeof body);
}

void send_telemetry(struct drive *drive, uint16_t sequence, const float signals[SIGNAL_COUNT])
{
    uint8_t body[LASHLOOP_TELEMETRY_BODY_LEN] = { LASHLOOP_TELEMETRY_KIND };
    size_t len = LASHLOOP_TELEMETRY_VALUES_OFFSET;
    put_bits(body + LASHLOOP_TELEMETRY_SEQUENCE_OFFSET, sequence, 2);
    for (int i = 0; i < SIGNAL_COUNT; i++) {
        if (drive->subscribed >> i & 1u) {
            put_f32(body + len, signals[i]);
            len += LASHLOOP_TELEMETRY_VALUES_ELEMENT_LEN;
        }
    }
    send_body(drive, body, len);
}
