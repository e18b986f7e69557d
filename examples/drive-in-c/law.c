#include "law.h"

#include <math.h>

enum { U32, F32 };
enum { FIXED, LIVE = LASHLOOP_PARAMETER_FLAGS_LIVE };

/* Gains and mechanics of tables 1 and 2 of Merzouki and Cadiou, doi:10.1016/j.conengprac.2004.10.016. */
const struct parameter PARAMETERS[PARAMETER_COUNT] = {
    [PERIOD_US] = { "period_us", "us", U32, FIXED, 1000, 100, 100000 },
    [MOTOR_COUNTS_PER_REV] = { "motor_counts_per_rev", "counts/rev", U32, FIXED, 131072, 4, 16777216 },
    [LOAD_COUNTS_PER_REV] = { "load_counts_per_rev", "counts/rev", U32, FIXED, 131072, 4, 16777216 },
    [WATCHDOG_US] = { "watchdog_us", "us", U32, FIXED, 20000, 200, 60000000 },
    [TORQUE_LIMIT_NM] = { "torque_limit_nm", "N m", F32, FIXED, 20, 0, 1000 },
    [MOTOR_SPEED_LIMIT_RAD_S] = { "motor_speed_limit_rad_s", "rad/s", F32, FIXED, 1000, 0.1, 1e6 },
    [LOAD_SPEED_LIMIT_RAD_S] = { "load_speed_limit_rad_s", "rad/s", F32, FIXED, 100, 0.1, 1e6 },
    [REDUCTION_RATIO] = { "reduction_ratio", "", F32, FIXED, 3, 1e-3, 1e4 },
    [STIFFNESS_NM_RAD] = { "stiffness_nm_rad", "N m/rad", F32, FIXED, 1, 0, 1e9 },
    [MOTOR_FILTER_RAD_S] = { "motor_filter_rad_s", "rad/s", F32, FIXED, 400, 0.01, 1e6 },
    [LOAD_FILTER_RAD_S] = { "load_filter_rad_s", "rad/s", F32, FIXED, 200, 0.01, 1e6 },
    [K_P1] = { "k_p1", "N m/rad", F32, LIVE, 1, 0, 1e6 },
    [K_D1] = { "k_d1", "N m s/rad", F32, LIVE, 0.01, 0, 1e6 },
    [K_P2] = { "k_p2", "", F32, LIVE, 10, 0, 1e6 },
    [K_D2] = { "k_d2", "s", F32, LIVE, 10, 0, 1e6 },
};

const struct signal SIGNALS[SIGNAL_COUNT] = {
    [REQUESTED_TORQUE_NM] = { "requested_torque_nm", "N m" },
    [LOAD_ERROR_RAD] = { "load_error_rad", "rad" },
    [MOTOR_ERROR_RAD] = { "motor_error_rad", "rad" },
};

static const float TAU = 6.283185307f;

void law_start(struct law *law, const double values[PARAMETER_COUNT])
{
    *law = (struct law){
        .period_s = (float)values[PERIOD_US] * 1e-6f,
        .motor_rad_per_count = TAU / (float)values[MOTOR_COUNTS_PER_REV],
        .load_rad_per_count = TAU / (float)values[LOAD_COUNTS_PER_REV],
        .ratio = (float)values[REDUCTION_RATIO],
        .stiffness_nm_rad = (float)values[STIFFNESS_NM_RAD],
        .motor_filter_rad_s = (float)values[MOTOR_FILTER_RAD_S],
        .load_filter_rad_s = (float)values[LOAD_FILTER_RAD_S],
    };
    law_update(law, values);
}

void law_update(struct law *law, const double values[PARAMETER_COUNT])
{
    law->k_p1 = (float)values[K_P1];
    law->k_d1 = (float)values[K_D1];
    law->k_p2 = (float)values[K_P2];
    law->k_d2 = (float)values[K_D2];
}

/* Difference quotient behind a first-order lag. The difference of counts is exact; that of two floats would not be. */
static void filter(float *velocity_rad_s, int64_t moved, float rad_per_count, float bandwidth_rad_s, float elapsed_s)
{
    float quotient = (float)moved * rad_per_count / elapsed_s;
    *velocity_rad_s += -expm1f(-bandwidth_rad_s * elapsed_s) * (quotient - *velocity_rad_s);
}

float law_step(struct law *law, const struct measurement *m, float signals[SIGNAL_COUNT])
{
    if (law->has_previous) {
        float elapsed_s = law->period_s * (float)m->periods;
        filter(&law->motor_velocity_rad_s, m->motor_counts - law->motor_counts, law->motor_rad_per_count,
               law->motor_filter_rad_s, elapsed_s);
        filter(&law->load_velocity_rad_s, m->load_counts - law->load_counts, law->load_rad_per_count,
               law->load_filter_rad_s, elapsed_s);
    }
    law->has_previous = 1;
    law->motor_counts = m->motor_counts;
    law->load_counts = m->load_counts;

    /* The outer loop turns the load error into a motor position, the inner loop the motor error into a torque. */
    float motor_rad = (float)m->motor_counts * law->motor_rad_per_count;
    float load_rad = (float)m->load_counts * law->load_rad_per_count;
    float load_error_rad = load_rad - m->reference_rad;
    float motor_command_rad =
        law->ratio * m->reference_rad - law->k_p2 * load_error_rad - law->k_d2 * law->load_velocity_rad_s;
    float motor_error_rad = motor_rad - motor_command_rad;
    float elastic_nm = law->stiffness_nm_rad * (motor_rad - law->ratio * load_rad);
    float torque_nm = -elastic_nm - law->k_p1 * motor_error_rad - law->k_d1 * law->motor_velocity_rad_s;

    signals[REQUESTED_TORQUE_NM] = torque_nm;
    signals[LOAD_ERROR_RAD] = load_error_rad;
    signals[MOTOR_ERROR_RAD] = motor_error_rad;
    return torque_nm;
}
