#include "drive.h"

#include "messages.h"
#include "safety.h"
#include "samples.h"

void drive_tick(struct drive *drive)
{
    if (check_watchdog(drive))
        send_fault(drive, &drive->fault);
}

static void power_up(struct drive *drive)
{
    for (int i = 0; i < PARAMETER_COUNT; i++)
        drive->values[i] = PARAMETERS[i].initial;
    drive->has_session = drive->has_fault = 0;
    drive->subscribed = drive->telemetry_every = 0;
    drive->last_sequence = 0;
    rest(drive, LASHLOOP_STATE_BOOT);
}

void drive_init(struct drive *drive, const struct board *board)
{
    *drive = (struct drive){ .board = board };
    power_up(drive);
}

static enum lashloop_outcome set_parameter(struct drive *drive, uint8_t index, const uint8_t *value)
{
    if (index >= PARAMETER_COUNT)
        return LASHLOOP_OUTCOME_UNKNOWN_INDEX;
    if (drive->state != LASHLOOP_STATE_IDLE)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    const struct parameter *parameter = &PARAMETERS[index];
    int is_float = value[0] == LASHLOOP_PARAMETER_TYPE_F32;
    if (is_float != parameter->is_float)
        return LASHLOOP_OUTCOME_WRONG_TYPE;
    /* The limits as the host reads them; NaN is outside every range. */
    double number = is_float ? (double)get_f32(value + 1) : (double)get_bits(value + 1, 4);
    double min = is_float ? (double)(float)parameter->min : parameter->min;
    double max = is_float ? (double)(float)parameter->max : parameter->max;
    if (!(number >= min && number <= max))
        return LASHLOOP_OUTCOME_OUT_OF_RANGE;
    drive->values[index] = number;
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome subscribe(struct drive *drive, uint32_t signals, uint16_t every)
{
    if (drive->state == LASHLOOP_STATE_BOOT || drive->state == LASHLOOP_STATE_FAULTED)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    if (signals >> SIGNAL_COUNT)
        return LASHLOOP_OUTCOME_UNKNOWN_INDEX;
    drive->subscribed = signals;
    drive->telemetry_every = every;
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome arm(struct drive *drive)
{
    if (drive->state != LASHLOOP_STATE_IDLE)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    if (!prepare_run(&drive->run, drive->values)) {
        send_log(drive, "a speed limit exceeds half the range of its encoder");
        return LASHLOOP_OUTCOME_INCONSISTENT;
    }
    drive->state = LASHLOOP_STATE_ARMED;
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome start(struct drive *drive)
{
    if (drive->state != LASHLOOP_STATE_ARMED)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    drive->run.fed_at_ns = drive->board->now_ns();
    drive->last_sequence = 0;
    drive->counters_at_start = drive->counters;
    drive->state = LASHLOOP_STATE_RUNNING;
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome stop(struct drive *drive)
{
    if (drive->state == LASHLOOP_STATE_BOOT || drive->state == LASHLOOP_STATE_FAULTED)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    rest(drive, LASHLOOP_STATE_IDLE);
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome clear_fault(struct drive *drive)
{
    if (drive->state != LASHLOOP_STATE_FAULTED)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    drive->has_fault = 0;
    drive->state = drive->has_session ? LASHLOOP_STATE_IDLE : LASHLOOP_STATE_BOOT;
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static void handshake(struct drive *drive, uint8_t version, uint32_t session)
{
    int is_same_version = version == LASHLOOP_PROTOCOL_VERSION;
    if (is_same_version && (!drive->has_session || session != drive->session)) {
        drive->has_session = 1;
        drive->session = session;
        if (drive->state != LASHLOOP_STATE_FAULTED)
            rest(drive, LASHLOOP_STATE_IDLE);
    }
    send_identity(drive, session);
    if (drive->has_fault)
        send_fault(drive, &drive->fault);
    if (!is_same_version)
        send_result(drive, LASHLOOP_HELLO_KIND, LASHLOOP_OUTCOME_VERSION_MISMATCH);
}

/* Whether a body is a message of the host: its length is that of its kind, and its fields are values of their types. */
static int is_message(const uint8_t *body, size_t len)
{
#define ROW(name, kind, body_len, ...) { kind, body_len },
    static const struct { uint8_t kind, len; } KINDS[] = { LASHLOOP_HOST_MESSAGES(ROW) };
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        if (KINDS[i].kind != body[0])
            continue;
        uint8_t type = body[0] == LASHLOOP_SET_PARAMETER_KIND ? body[LASHLOOP_SET_PARAMETER_VALUE_OFFSET]
                                                              : LASHLOOP_PARAMETER_TYPE_U32;
        return KINDS[i].len == len && (type == LASHLOOP_PARAMETER_TYPE_U32 || type == LASHLOOP_PARAMETER_TYPE_F32);
    }
    return 0;
}

static void handle(struct drive *drive, const uint8_t *body)
{
    uint8_t kind = body[0], index = body[1];
    int is_session = drive->has_session && get_bits(body + LASHLOOP_ARM_SESSION_OFFSET, 4) == drive->session;
    switch (kind) {
    case LASHLOOP_HELLO_KIND:
        handshake(drive, body[LASHLOOP_HELLO_PROTOCOL_VERSION_OFFSET], get_bits(body + LASHLOOP_HELLO_SESSION_OFFSET, 4));
        break;
    case LASHLOOP_DESCRIBE_PARAMETER_KIND:
        describe_parameter(drive, index);
        break;
    case LASHLOOP_DESCRIBE_LAW_KIND:
        describe_law(drive, index);
        break;
    case LASHLOOP_DESCRIBE_SIGNAL_KIND:
        describe_signal(drive, index);
        break;
    case LASHLOOP_DESCRIBE_CHOICE_KIND: /* no parameter of this drive has choices */
        send_result(drive, kind, LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        break;
    case LASHLOOP_GET_PARAMETER_KIND:
        answer_parameter(drive, index,
                         index < PARAMETER_COUNT ? LASHLOOP_OUTCOME_ACCEPTED : LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        break;
    case LASHLOOP_SET_PARAMETER_KIND:
        answer_parameter(drive, index, set_parameter(drive, index, body + LASHLOOP_SET_PARAMETER_VALUE_OFFSET));
        break;
    case LASHLOOP_SUBSCRIBE_KIND:
        send_result(drive, kind, subscribe(drive, get_bits(body + LASHLOOP_SUBSCRIBE_SIGNALS_OFFSET, 4),
                                           (uint16_t)get_bits(body + LASHLOOP_SUBSCRIBE_EVERY_OFFSET, 2)));
        break;
    case LASHLOOP_ARM_KIND:
        send_result(drive, kind, is_session ? arm(drive) : LASHLOOP_OUTCOME_WRONG_SESSION);
        break;
    case LASHLOOP_START_KIND:
        send_result(drive, kind, is_session ? start(drive) : LASHLOOP_OUTCOME_WRONG_SESSION);
        break;
    case LASHLOOP_STOP_KIND: {
        enum lashloop_outcome outcome = stop(drive);
        send_line_report(drive);
        send_result(drive, kind, outcome);
        break;
    }
    case LASHLOOP_EMERGENCY_STOP_KIND: {
        struct fault fault = latch(drive, LASHLOOP_FAULT_CODE_EMERGENCY_STOP, 0, 0);
        send_fault(drive, &fault);
        send_result(drive, kind, LASHLOOP_OUTCOME_ACCEPTED);
        break;
    }
    case LASHLOOP_CLEAR_FAULT_KIND:
        send_result(drive, kind, clear_fault(drive));
        break;
    case LASHLOOP_RESET_KIND:
        power_up(drive);
        send_result(drive, kind, LASHLOOP_OUTCOME_ACCEPTED);
        break;
    case LASHLOOP_ENCODER_SAMPLE_KIND:
        take_sample(drive, body);
        break;
    case LASHLOOP_REFERENCE_KIND: /* this drive has no bench mode */
    case LASHLOOP_ENTER_LOADER_KIND: /* nor a boot loader */
        send_result(drive, kind, LASHLOOP_OUTCOME_WRONG_STATE);
        break;
    }
}

void drive_receive(struct drive *drive, uint8_t byte)
{
    switch (receiver_take(&drive->receiver, byte)) {
    case RECEIVED_NOTHING:
        break;
    case RECEIVED_DAMAGE:
        drive->counters.damaged++;
        break;
    case RECEIVED_BODY:
        if (is_message(drive->receiver.bytes, drive->receiver.len)) {
            drive->counters.messages++;
            handle(drive, drive->receiver.bytes);
        } else {
            drive->counters.refused++;
        }
        break;
    }
}
