/* The control loop as plainly as C has it: plant, encoders and law in one program, without frames, record or metrics. Plant,
 * encoders and law (`pd` in single precision, as section 17 of docs/protocol.md specifies it) have the values of
 * scenarios/shaft-pd.toml. Reads lines "loop PERIODS" and prints the processor time in ns and the final positions of load and
 * motor. */
#include "plants.h"

static const double TURN = 6.283185307179586, COUNTS_PER_REV = 4000.0;
static const float RATIO = 3.0f, STIFFNESS = 1.0f, K_P1 = 1.0f, K_D1 = 0.01f, K_P2 = 10.0f, K_D2 = 10.0f, K_1 = 1.0f;
static const float PERIOD_S = 1e-3f, MOTOR_FILTER = 400.0f, LOAD_FILTER = 200.0f, LIMIT_NM = 20.0f;

/* An encoder with its velocity filter. A position is the middle of its count. */
typedef struct {
    float half_count, alpha, velocity;
    long counts;
} Encoder;

static long counts(double rad) { return (long)floor(rad * (COUNTS_PER_REV / TURN)); }

static Encoder encoder(float bandwidth, double rad) {
    return (Encoder){(float)(0.5 * TURN) / (float)COUNTS_PER_REV, -expm1f(-(bandwidth * PERIOD_S)), 0.0f, counts(rad)};
}

static void sample(Encoder *e, double rad) {
    const long now = counts(rad), moved = now - e->counts;
    const float velocity = (float)(2 * moved) * e->half_count / PERIOD_S;
    e->counts = now;
    e->velocity += e->alpha * (velocity - e->velocity);
}

static float law(const Encoder *motor, const Encoder *load, float reference) {
    const long motor_half = 2 * motor->counts + 1, load_half = 2 * load->counts + 1;
    const float motor_position = (float)motor_half * motor->half_count;
    const float load_error = (float)load_half * load->half_count - reference;
    const float twist = (float)(motor_half - (long)RATIO * load_half) * motor->half_count;
    const float motor_reference = RATIO * reference - K_D2 * load->velocity - K_P2 * load_error;
    const float motor_error = motor_position - motor_reference;
    return -(K_1 * (STIFFNESS * twist)) - K_D1 * motor->velocity - K_P1 * motor_error;
}

static void run(State *s, long periods) {
    memset(s, 0, sizeof *s);
    s->load = s->motor = FORWARDS;
    s->x[LOAD] = 0.25 * TURN;
    s->x[MOTOR] = 0.75 * TURN;
    Encoder motor = encoder(MOTOR_FILTER, s->x[MOTOR]), load = encoder(LOAD_FILTER, s->x[LOAD]);
    /* A torque reaches the motor one period after its sample. */
    double torque = 0.0;
    for (long k = 0; k < periods; k++) {
        sample(&motor, s->x[MOTOR]);
        sample(&load, s->x[LOAD]);
        const float wanted = law(&motor, &load, 0.0f);
        period(&SHAFT_PLANT, s, torque);
        torque = fmaxf(-LIMIT_NM, fminf(LIMIT_NM, wanted));
    }
}

int main(void) {
    long periods;
    while (scanf("%*s %ld", &periods) == 1) {
        State s;
        const double from_ns = clock_ns(CLOCK_PROCESS_CPUTIME_ID);
        run(&s, periods);
        printf("%.17g %.17g %.17g\n", clock_ns(CLOCK_PROCESS_CPUTIME_ID) - from_ns, s.x[LOAD], s.x[MOTOR]);
        fflush(stdout);
    }
    return 0;
}
