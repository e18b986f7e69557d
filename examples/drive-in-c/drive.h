/* The drive as a state machine without I/O: sessions, parameters, faults, watchdog, samples and torques.
 * Sections 4 to 12 of docs/protocol.md. */

#ifndef DRIVE_H
#define DRIVE_H

#include "frame.h"
#include "law.h"

_Static_assert(PARAMETER_COUNT <= LASHLOOP_MAX_PARAMETERS, "the indices above are lists of DescribeChoice");
_Static_assert(SIGNAL_COUNT >= 1 && SIGNAL_COUNT <= LASHLOOP_MAX_SIGNALS, "1 to 32 signals: each is a bit of Subscribe");

/* What the drive needs of its owner. */
struct board {
    uint64_t (*now_ns)(void);                        /* device time; must never run backwards */
    void (*send)(const uint8_t *bytes, size_t len);  /* one frame to the host */
    void (*set_torque)(float torque_nm);             /* to the power stage */
};

struct counters {
    uint32_t messages, damaged, refused;
};

struct fault {
    uint8_t code;
    uint16_t sequence;
    float value, limit;
};

/* The request that is being answered. */
struct request {
    uint8_t kind, number;
    uint32_t detail; /* of its outcome */
};

/* A run: what holds from Arm to the end of the torque. */
struct run {
    struct law law;
    double values[PARAMETER_COUNT]; /* as of Arm; live ones as set since */
    double motor_rad_s_per_count, load_rad_s_per_count;
    int longest_gap; /* periods */
    int has_sample;
    int32_t motor_reading, load_reading;
    int64_t motor_counts, load_counts;
    uint64_t fed_at_ns; /* the watchdog */
    uint8_t last_answer[LASHLOOP_TORQUE_ANSWER_BODY_LEN];
};

struct drive {
    const struct board *board;
    enum lashloop_state state;
    int has_session, has_fault;
    uint32_t session;
    struct request request;
    struct fault fault; /* the first one since it was cleared */
    double values[PARAMETER_COUNT];
    uint32_t subscribed; /* bit n: signal n */
    uint16_t telemetry_every;
    float torque_nm;
    uint16_t last_sequence; /* last sample accepted since the last Start; 0 before the first */
    struct run run;
    struct receiver receiver;
    struct counters counters, counters_at_start;
};

/* The state after power-up. */
void drive_init(struct drive *drive, const struct board *board);

/* Takes one byte of the line and answers the message that it completes. */
void drive_receive(struct drive *drive, uint8_t byte);

/* Checks the watchdog; call it about every millisecond. */
void drive_tick(struct drive *drive);

#endif
