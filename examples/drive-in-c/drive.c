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
    const struct parameter *parameter = &PARAMETERS[index];
    int is_armed = drive->state == LASHLOOP_STATE_ARMED || drive->state == LASHLOOP_STATE_RUNNING;
    int is_live = is_armed && (parameter->flags & LASHLOOP_PARAMETER_FLAGS_LIVE);
    if (drive->state != LASHLOOP_STATE_IDLE && !is_live)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    int is_float = parameter->is_float;
    if (value[0] != (is_float ? LASHLOOP_PARAMETER_TYPE_F32 : LASHLOOP_PARAMETER_TYPE_U32))
        return LASHLOOP_OUTCOME_WRONG_TYPE;
    /* The limits as the host reads them; NaN is outside every range. */
    double number = is_float ? (double)get_f32(value + 1) : (double)get_bits(value + 1, 4);
    double min = is_float ? (double)(float)parameter->min : parameter->min;
    double max = is_float ? (double)(float)parameter->max : parameter->max;
    if (!(number >= min && number <= max))
        return LASHLOOP_OUTCOME_OUT_OF_RANGE;
    drive->values[index] = number;
    if (is_live) {
        drive->run.values[index] = number;
        law_update(&drive->run.law, drive->run.values);
    }
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome subscribe(struct drive *drive, uint32_t signals, uint16_t every)
{
    if (drive->state == LASHLOOP_STATE_BOOT || drive->state == LASHLOOP_STATE_FAULTED)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    int count = 0;
    for (int i = 0; i < LASHLOOP_MAX_SIGNALS; i++) {
        int is_subscribed = signals >> i & 1u;
        if (is_subscribed && i >= SIGNAL_COUNT)
            return LASHLOOP_OUTCOME_UNKNOWN_INDEX;
        count += is_subscribed;
    }
    if (count > LASHLOOP_MAX_TELEMETRY_VALUES)
        return LASHLOOP_OUTCOME_OUT_OF_RANGE;
    drive->subscribed = signals;
    drive->telemetry_every = every;
    return LASHLOOP_OUTCOME_ACCEPTED;
}

static enum lashloop_outcome arm(struct drive *drive)
{
    if (drive->state != LASHLOOP_STATE_IDLE)
        return LASHLOOP_OUTCOME_WRONG_STATE;
    int inconsistent = prepare_run(&drive->run, drive->values);
    if (inconsistent < PARAMETER_COUNT) {
        drive->request.detail = (uint32_t)inconsistent;
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
        send_result(drive, LASHLOOP_OUTCOME_VERSION_MISMATCH);
}

enum taken { REFUSED, KNOWN, UNKNOWN };

/* Whether a body is a message of the host. A newer host may send other kinds, other types of values, longer bodies. */
static enum taken taken_of(const uint8_t *body, size_t len)
{
#define ROW(name, kind, shortest_len, ...) { kind, shortest_len },
    static const struct { uint8_t kind, shortest_len; } KINDS[] = { LASHLOOP_HOST_MESSAGES(ROW) };
    uint8_t kind = body[0];
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        if (KINDS[i].kind != kind)
            continue;
        if (len < KINDS[i].shortest_len)
            return REFUSED;
        return kind == LASHLOOP_SET_PARAMETER_KIND && body[LASHLOOP_SET_PARAMETER_VALUE_OFFSET] == 0 ? REFUSED : KNOWN;
    }
    /* The kinds above are those of drives, and 0 is never used. */
    return kind >= 0x01 && kind <= 0x7f ? UNKNOWN : REFUSED;
}

static void handle(struct drive *drive, const uint8_t *body)
{
    uint8_t index = body[LASHLOOP_GET_PARAMETER_INDEX_OFFSET];
    int is_session = drive->has_session && get_bits(body + LASHLOOP_ARM_SESSION_OFFSET, 4) == drive->session;
    switch (drive->request.kind) {
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
    case LASHLOOP_DESCRIBE_CHOICE_KIND:
        describe_choice(drive, body[LASHLOOP_DESCRIBE_CHOICE_PARAMETER_OFFSET],
                        body[LASHLOOP_DESCRIBE_CHOICE_CHOICE_OFFSET]);
        break;
    case LASHLOOP_GET_PARAMETER_KIND:
        answer_parameter(drive, index,
                         index < PARAMETER_COUNT ? LASHLOOP_OUTCOME_ACCEPTED : LASHLOOP_OUTCOME_UNKNOWN_INDEX);
        break;
    case LASHLOOP_SET_PARAMETER_KIND:
        answer_parameter(drive, index, set_parameter(drive, index, body + LASHLOOP_SET_PARAMETER_VALUE_OFFSET));
        break;
    case LASHLOOP_SUBSCRIBE_KIND:
        send_result(drive, subscribe(drive, get_bits(body + LASHLOOP_SUBSCRIBE_SIGNALS_OFFSET, 4),
                                     (uint16_t)get_bits(body + LASHLOOP_SUBSCRIBE_EVERY_OFFSET, 2)));
        break;
    case LASHLOOP_ARM_KIND:
        send_result(drive, is_session ? arm(drive) : LASHLOOP_OUTCOME_WRONG_SESSION);
        break;
    case LASHLOOP_START_KIND:
        send_result(drive, is_session ? start(drive) : LASHLOOP_OUTCOME_WRONG_SESSION);
        break;
    case LASHLOOP_STOP_KIND: {
        enum lashloop_outcome outcome = stop(drive);
        send_line_report(drive);
        send_result(drive, outcome);
        break;
    }
    case LASHLOOP_EMERGENCY_STOP_KIND: {
        struct fault fault = latch(drive, LASHLOOP_FAULT_CODE_EMERGENCY_STOP, 0, 0);
        send_fault(drive, &fault);
        send_result(drive, LASHLOOP_OUTCOME_ACCEPTED);
        break;
    }
    case LASHLOOP_CLEAR_FAULT_KIND:
        send_result(drive, clear_fault(drive));
        break;
    case LASHLOOP_RESET_KIND:
        power_up(drive);
        send_result(drive, LASHLOOP_OUTCOME_ACCEPTED);
        break;
    case LASHLOOP_ENCODER_SAMPLE_KIND:
        take_sample(drive, body);
        break;
    case LASHLOOP_REFERENCE_KIND:    /* this drive has no bench mode */
    case LASHLOOP_ENTER_LOADER_KIND: /* nor a boot loader */
        send_result(drive, LASHLOOP_OUTCOME_WRONG_STATE);
        break;
    default: /* it stores and captures nothing, and has no encoders */
        send_result(drive, LASHLOOP_OUTCOME_UNKNOWN_REQUEST);
        break;
    }
}

static void receive_body(struct drive *drive, const uint8_t *body, size_t len)
{
    enum taken taken = taken_of(body, len);
    if (taken == REFUSED) {
        drive->counters.refused++;
        return;
    }
    int has_number = LASHLOOP_HAS_NUMBER(body[0]) && len > LASHLOOP_NUMBER_OFFSET;
    drive->request = (struct request){ .kind = body[0], .number = has_number ? body[LASHLOOP_NUMBER_OFFSET] : 0 };
    drive->counters.messages++;
    if (taken == KNOWN)
        handle(drive, body);
    else if (LASHLOOP_HAS_NUMBER(body[0])) /* what has no number asks for no answer */
        send_result(drive, LASHLOOP_OUTCOME_UNKNOWN_REQUEST);
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
        receive_body(drive, drive->receiver.bytes, drive->receiver.len);
        break;
    }
}
