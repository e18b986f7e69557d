/* The control law, and the parameters of the drive. This is the file to replace. */

#ifndef LAW_H
#define LAW_H

#include <stdint.h>

#include "lashloop.h"

#define LAW_NAME "cascade" /* as scenarios name it */

/* A parameter. A double represents every U32 and every F32 exactly. */
struct parameter {
    const char *name; /* ends in the unit */
    const char *unit; /* empty for a pure number */
    int is_float;
    uint8_t flags; /* LASHLOOP_PARAMETER_FLAGS_* */
    double initial, min, max;
};

enum {
    /* Required of every drive. */
    PERIOD_US,
    MOTOR_COUNTS_PER_REV,
    LOAD_COUNTS_PER_REV,
    WATCHDOG_US,
    /* Limits of this drive. */
    TORQUE_LIMIT_NM,
    MOTOR_SPEED_LIMIT_RAD_S,
    LOAD_SPEED_LIMIT_RAD_S,
    /* The law. */
    REDUCTION_RATIO,
    STIFFNESS_NM_RAD,
    MOTOR_FILTER_RAD_S,
    LOAD_FILTER_RAD_S,
    K_P1,
    K_D1,
    K_P2,
    K_D2,
    PARAMETER_COUNT
};
extern const struct parameter PARAMETERS[PARAMETER_COUNT];

/* A signal for telemetry. */
struct signal {
    const char *name, *unit;
};

enum { REQUESTED_TORQUE_NM, LOAD_ERROR_RAD, MOTOR_ERROR_RAD, SIGNAL_COUNT };
extern const struct signal SIGNALS[SIGNAL_COUNT];

/* One sample. Positions are in counts without wraparound. */
struct measurement {
    int64_t motor_counts, load_counts;
    float reference_rad;
    int periods; /* since the previous sample; more than 1 if samples are missing */
};

/* The law with its state. */
struct law {
    float period_s, motor_rad_per_count, load_rad_per_count;
    float ratio, stiffness_nm_rad;
    float motor_filter_rad_s, load_filter_rad_s;
    float k_p1, k_d1, k_p2, k_d2;
    int has_previous;
    int64_t motor_counts, load_counts;
    float motor_velocity_rad_s, load_velocity_rad_s;
};

/* Starts the law with the values in force. */
void law_start(struct law *law, const double values[PARAMETER_COUNT]);

/* Takes over the values of live parameters, between two control steps; the state of the law remains. */
void law_update(struct law *law, const double values[PARAMETER_COUNT]);

/* Makes one control step: returns the torque in N m and fills the signals. */
float law_step(struct law *law, const struct measurement *measurement, float signals[SIGNAL_COUNT]);

#endif
