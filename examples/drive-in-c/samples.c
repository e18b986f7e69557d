#include "samples.h"

#include <math.h>
#include <string.h>

#include "messages.h"
#include "safety.h"

#define HALF_RANGE 0x800000 /* counts; encoders have 24 bits */
#define LONGEST_GAP 1000    /* periods */

/* Speed of one count per period; lowers the longest gap to the periods within which the encoder is unambiguous. */
static double rad_s_per_count(struct run *run, int counts_per_rev, int speed_limit)
{
    double scale = 2 * 3.14159265358979323846 / (run->values[counts_per_rev] * run->values[PERIOD_US] * 1e-6);
    double gap = floor((HALF_RANGE - 2) * scale / (float)run->values[speed_limit]);
    if (gap < run->longest_gap)
        run->longest_gap = (int)gap;
    return scale;
}

int prepare_run(struct run *run, const double values[PARAMETER_COUNT])
{
    *run = (struct run){ .longest_gap = LONGEST_GAP };
    memcpy(run->values, values, sizeof run->values);
    run->motor_rad_s_per_count = rad_s_per_count(run, MOTOR_COUNTS_PER_REV, MOTOR_SPEED_LIMIT_RAD_S);
    if (run->longest_gap < 1)
        return MOTOR_SPEED_LIMIT_RAD_S;
    run->load_rad_s_per_count = rad_s_per_count(run, LOAD_COUNTS_PER_REV, LOAD_SPEED_LIMIT_RAD_S);
    if (run->longest_gap < 1)
        return LOAD_SPEED_LIMIT_RAD_S;
    law_start(&run->law, run->values);
    return PARAMETER_COUNT;
}

static void answer_sample(struct drive *drive, uint16_t sequence, uint8_t flags, uint64_t arrived_ns)
{
    uint8_t *body = drive->run.last_answer;
    uint64_t tenths_us = (drive->board->now_ns() - arrived_ns) / 100;
    body[0] = LASHLOOP_TORQUE_ANSWER_KIND;
    put_bits(body + LASHLOOP_TORQUE_ANSWER_SEQUENCE_OFFSET, sequence, 2);
    put_f32(body + LASHLOOP_TORQUE_ANSWER_TORQUE_NM_OFFSET, drive->torque_nm);
    body[LASHLOOP_TORQUE_ANSWER_STATUS_OFFSET] = (uint8_t)(drive->state | flags);
    put_bits(body + LASHLOOP_TORQUE_ANSWER_COMPUTE_TENTHS_US_OFFSET, tenths_us > 0xffff ? 0xffff : (uint32_t)tenths_us, 2);
    send_body(drive, body, LASHLOOP_TORQUE_ANSWER_BODY_LEN);
}

static int32_t wrapped(int32_t difference)
{
    uint32_t bits = (uint32_t)difference & 0xffffffu;
    return bits < HALF_RANGE ? (int32_t)bits : (int32_t)bits - 2 * HALF_RANGE;
}

/* The least speed that explains a difference of readings: a single count may come from no travel at all. */
static float least_speed(int32_t moved, double rad_s_per_count, int periods)
{
    int32_t counts = moved < 0 ? -moved : moved;
    return (float)((counts > 1 ? counts - 1 : 0) * rad_s_per_count / periods);
}

/* A control step over `periods` periods: checks, law, limit. Latches a fault instead of a torque. */
static void control_step(struct drive *drive, const uint8_t *sample, int periods, uint64_t arrived_ns)
{
    struct run *run = &drive->run;
    uint16_t sequence = (uint16_t)get_bits(sample + LASHLOOP_ENCODER_SAMPLE_SEQUENCE_OFFSET, 2);
    int32_t motor = get_i24(sample + LASHLOOP_ENCODER_SAMPLE_MOTOR_COUNTS_OFFSET);
    int32_t load = get_i24(sample + LASHLOOP_ENCODER_SAMPLE_LOAD_COUNTS_OFFSET);
    float reference_rad = get_f32(sample + LASHLOOP_ENCODER_SAMPLE_REFERENCE_RAD_OFFSET);
    /* The first readings are the positions themselves, from zero; they have no speed. */
    int32_t motor_moved = run->has_sample ? wrapped(motor - run->motor_reading) : 0;
    int32_t load_moved = run->has_sample ? wrapped(load - run->load_reading) : 0;
    float motor_rad_s = least_speed(motor_moved, run->motor_rad_s_per_count, periods);
    float load_rad_s = least_speed(load_moved, run->load_rad_s_per_count, periods);
    float motor_limit = (float)run->values[MOTOR_SPEED_LIMIT_RAD_S];
    float load_limit = (float)run->values[LOAD_SPEED_LIMIT_RAD_S];
    float torque_limit = (float)run->values[TORQUE_LIMIT_NM];
    float signals[SIGNAL_COUNT] = { 0 };
    uint8_t flags = periods > 1 ? LASHLOOP_TORQUE_FLAGS_GAP : 0;

    run->motor_counts = run->has_sample ? run->motor_counts + motor_moved : motor;
    run->load_counts = run->has_sample ? run->load_counts + load_moved : load;
    run->motor_reading = motor;
    run->load_reading = load;
    run->has_sample = 1;
    drive->last_sequence = sequence;
    run->fed_at_ns = arrived_ns;

    if (!isfinite(reference_rad)) {
        latch(drive, LASHLOOP_FAULT_CODE_REFERENCE_NOT_FINITE, reference_rad, 0);
    } else if (!(motor_rad_s <= motor_limit)) {
        latch(drive, LASHLOOP_FAULT_CODE_MOTOR_ENCODER_JUMP, motor_rad_s, motor_limit);
    } else if (!(load_rad_s <= load_limit)) {
        latch(drive, LASHLOOP_FAULT_CODE_LOAD_ENCODER_JUMP, load_rad_s, load_limit);
    } else {
        struct measurement measurement = { run->motor_counts, run->load_counts, reference_rad, periods };
        float requested_nm = law_step(&run->law, &measurement, signals);
        if (!isfinite(requested_nm)) {
            latch(drive, LASHLOOP_FAULT_CODE_TORQUE_NOT_FINITE, requested_nm, torque_limit);
        } else {
            if (fabsf(requested_nm) > torque_limit)
                flags |= LASHLOOP_TORQUE_FLAGS_SATURATED;
            set_torque(drive, fmaxf(-torque_limit, fminf(requested_nm, torque_limit)));
        }
    }
    /* The torque comes first. */
    answer_sample(drive, sequence, flags, arrived_ns);
    if (drive->state == LASHLOOP_STATE_FAULTED)
        send_fault(drive, &drive->fault);
    else if (drive->subscribed && drive->telemetry_every && sequence % drive->telemetry_every == 0)
        send_telemetry(drive, sequence, signals);
}

void take_sample(struct drive *drive, const uint8_t *sample)
{
    struct run *run = &drive->run;
    uint64_t arrived_ns = drive->board->now_ns();
    uint16_t sequence = (uint16_t)get_bits(sample + LASHLOOP_ENCODER_SAMPLE_SEQUENCE_OFFSET, 2);
    /* A sample later than the watchdog allows gets no torque, even without a tick in between. */
    int has_tripped = check_watchdog(drive);
    if (drive->state == LASHLOOP_STATE_BOOT) {
        send_result(drive, LASHLOOP_OUTCOME_WRONG_STATE);
        return;
    }
    if (drive->state != LASHLOOP_STATE_RUNNING) {
        answer_sample(drive, sequence, 0, arrived_ns);
        if (has_tripped)
            send_fault(drive, &drive->fault);
        return;
    }
    int periods = run->has_sample ? (uint16_t)(sequence - drive->last_sequence) : sequence == 0 ? 1 : -1;
    if (periods == 0) {
        run->last_answer[LASHLOOP_TORQUE_ANSWER_STATUS_OFFSET] |= LASHLOOP_TORQUE_FLAGS_REPEATED;
        send_body(drive, run->last_answer, sizeof run->last_answer);
    } else if (periods >= 1 && periods <= run->longest_gap) {
        control_step(drive, sample, periods, arrived_ns);
    } else {
        send_result(drive, LASHLOOP_OUTCOME_OUT_OF_SEQUENCE);
    }
}
