/* The steps of the three plants in plain C: fourth-order Runge-Kutta, events located by the Illinois method, energies
 * integrated as additional states. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { LOAD, LOAD_V, MOTOR, MOTOR_V, SUPPLIED, DISSIPATED, N };
enum { STICK = 0, BACKWARDS = -1, FORWARDS = 1 };

static const double Jm = 9.72e-4, fm = 4.3e-4, Js = 7.5, fs = 16.0, N0 = 3.0, K = 1.0, j0 = 0.16;

/* Hard gap. */
static const double Fc = 3.84;

/* Backlash shaft. */
static const double c_shaft = 3.1e-3, lag_s = 5e-4, saturation = 20.0;
static const double FcL = 3.40, FsL = 3.82, vsL = 0.03, FcM = 0.02, FsM = 0.025, vsM = 0.2;

typedef struct {
    double x[N];
    double gap, tau;      /* backlash shaft only */
    int contact;          /* -1, 0, 1 */
    int load, motor;      /* friction */
} State;

typedef struct {
    double h, half_lag, lag, relaxation;
} Stride;

typedef struct {
    int guards, substeps;
    Stride (*stride)(double h);
    void (*flow)(const State *, double torque, const Stride *, State *next);
    double (*guard)(int, const State *);
    void (*become)(int, State *);
    void (*settle)(State *, double torque);
} Plant;

#define RUNGE_KUTTA(RATES)                                                                                     \
    double k1[N], k2[N], k3[N], k4[N], y[N];                                                                   \
    const double h = stride->h;                                                                                \
    RATES(s->x, 0, k1);                                                                                        \
    for (int i = 0; i < N; i++) y[i] = s->x[i] + 0.5 * h * k1[i];                                              \
    RATES(y, 1, k2);                                                                                           \
    for (int i = 0; i < N; i++) y[i] = s->x[i] + 0.5 * h * k2[i];                                              \
    RATES(y, 1, k3);                                                                                           \
    for (int i = 0; i < N; i++) y[i] = s->x[i] + h * k3[i];                                                    \
    RATES(y, 2, k4);                                                                                           \
    *next = *s;                                                                                                \
    for (int i = 0; i < N; i++) next->x[i] = s->x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);

static Stride plain_stride(double h) { return (Stride){h, 0, 0, 0}; }

static double twist(const double *x) { return x[MOTOR] - N0 * x[LOAD]; }

static void masses(const double *x, double C, double torque, double dry, double *k) {
    k[LOAD] = x[LOAD_V];
    k[LOAD_V] = (N0 * C - fs * x[LOAD_V] - dry) / Js;
    k[MOTOR] = x[MOTOR_V];
    k[MOTOR_V] = (torque - C - fm * x[MOTOR_V]) / Jm;
    k[SUPPLIED] = torque * x[MOTOR_V];
    k[DISSIPATED] = (fs * x[LOAD_V] + dry) * x[LOAD_V] + fm * x[MOTOR_V] * x[MOTOR_V];
}

/* ---- smooth ---- */

static void smooth_flow(const State *s, double torque, const Stride *stride, State *next) {
#define SMOOTH(X, STAGE, OUT)                                                                                  \
    do {                                                                                                       \
        double z = twist(X);                                                                                   \
        masses(X, K * (z - 4.0 * j0 * tanh(z / (4.0 * j0))), torque, 0.0, OUT);                                \
    } while (0)
    RUNGE_KUTTA(SMOOTH)
}

static void no_settle(State *s, double torque) { (void)s, (void)torque; }

/* ---- hard gap and Coulomb friction ---- */

static double hard_torque(const State *s, const double *x) {
    return s->contact ? K * (twist(x) - s->contact * j0) : 0.0;
}

static void hard_flow(const State *s, double torque, const Stride *stride, State *next) {
    const double dry = s->load * Fc;
#define HARD(X, STAGE, OUT)                                                                                    \
    do {                                                                                                       \
        masses(X, hard_torque(s, X), torque, dry, OUT);                                                        \
        if (s->load == STICK) OUT[LOAD] = OUT[LOAD_V] = 0.0;                                                   \
    } while (0)
    RUNGE_KUTTA(HARD)
}

static int at_rest(double drive, double limit) {
    return drive > limit ? FORWARDS : drive < -limit ? BACKWARDS : STICK;
}

static double friction_guard(int friction, double v, double drive, double limit) {
    return friction == STICK ? limit - fabs(drive) : friction * v;
}

static int friction_after(int friction, double drive, double limit) {
    if (friction == STICK) return drive < 0.0 ? BACKWARDS : FORWARDS;
    return at_rest(drive, limit);
}

static double hard_guard(int guard, const State *s) {
    double z = twist(s->x);
    switch (guard) {
    case 0: return s->contact == 0 ? z + j0 : s->contact < 0 ? -j0 - z : j0;
    case 1: return s->contact == 0 ? j0 - z : s->contact > 0 ? z - j0 : j0;
    default: return friction_guard(s->load, s->x[LOAD_V], N0 * hard_torque(s, s->x), Fc);
    }
}

static void hard_become(int guard, State *s) {
    if (guard == 2) {
        s->x[LOAD_V] = 0.0;
        s->load = friction_after(s->load, N0 * hard_torque(s, s->x), Fc);
        return;
    }
    int side = guard ? 1 : -1;
    s->x[MOTOR] = N0 * s->x[LOAD] + side * j0;
    s->contact = s->contact ? 0 : side;
}

static void hard_settle(State *s, double torque) {
    (void)torque;
    if (s->x[LOAD_V] == 0.0) s->load = at_rest(N0 * hard_torque(s, s->x), Fc);
}

/* ---- backlash shaft ---- */

static Stride shaft_stride(double h) {
    double half = exp(-0.5 * h / lag_s);
    return (Stride){h, half, half * half, exp(-h * K / c_shaft)};
}

static double shaft(const State *s, const double *x) {
    return K * (twist(x) - s->gap) + c_shaft * (x[MOTOR_V] - N0 * x[LOAD_V]);
}

static double transmitted(const State *s) { return s->contact ? shaft(s, s->x) : 0.0; }

static double stribeck(double v, double fc, double fs_, double vs) {
    double q = v / vs;
    q *= q;
    return q > 40.0 ? fc : fc + (fs_ - fc) * exp(-q);
}

static void shaft_rates(const State *s, const double *x, double tau, double *k) {
    double vl = x[LOAD_V], vm = x[MOTOR_V], C = 0.0, lost = 0.0;
    if (s->contact) {
        double dz = vm - N0 * vl;
        C = K * (twist(x) - s->gap) + c_shaft * dz;
        lost = c_shaft * dz * dz;
    }
    k[LOAD] = k[LOAD_V] = k[MOTOR] = k[MOTOR_V] = 0.0;
    if (s->load != STICK) {
        double f = fs * vl + s->load * stribeck(vl, FcL, FsL, vsL);
        lost += f * vl;
        k[LOAD] = vl;
        k[LOAD_V] = (N0 * C - f) / Js;
    }
    if (s->motor != STICK) {
        double f = fm * vm + s->motor * stribeck(vm, FcM, FsM, vsM);
        lost += f * vm;
        k[MOTOR] = vm;
        k[MOTOR_V] = (tau - C - f) / Jm;
    }
    k[SUPPLIED] = tau * vm;
    k[DISSIPATED] = lost;
}

static double command(double torque) { return fmax(-saturation, fmin(saturation, torque)); }

static void shaft_flow(const State *s, double torque, const Stride *stride, State *next) {
    const double u = command(torque);
    const double taus[3] = {s->tau, u + (s->tau - u) * stride->half_lag, u + (s->tau - u) * stride->lag};
#define SHAFT(X, STAGE, OUT) shaft_rates(s, X, taus[STAGE], OUT)
    RUNGE_KUTTA(SHAFT)
    next->tau = taus[2];
    if (!s->contact) {
        double before = twist(s->x) - s->gap, after = before * stride->relaxation;
        next->gap = twist(next->x) - after;
        next->x[DISSIPATED] += 0.5 * K * (before - after) * (before + after);
    }
}

static double shaft_guard(int guard, const State *s) {
    switch (guard) {
    case 0: return s->contact == 0 ? s->gap + j0 : s->contact < 0 ? -shaft(s, s->x) : j0;
    case 1: return s->contact == 0 ? j0 - s->gap : s->contact > 0 ? shaft(s, s->x) : j0;
    case 2: return friction_guard(s->load, s->x[LOAD_V], N0 * transmitted(s), FsL);
    default: return friction_guard(s->motor, s->x[MOTOR_V], s->tau - transmitted(s), FsM);
    }
}

static void shaft_settle(State *s, double torque) {
    (void)torque;
    if (s->x[LOAD_V] == 0.0) s->load = at_rest(N0 * transmitted(s), FsL);
    if (s->x[MOTOR_V] == 0.0) s->motor = at_rest(s->tau - transmitted(s), FsM);
}

static void shaft_become(int guard, State *s) {
    if (guard == 2) {
        s->x[LOAD_V] = 0.0;
        s->load = friction_after(s->load, N0 * transmitted(s), FsL);
    } else if (guard == 3) {
        s->x[MOTOR_V] = 0.0;
        s->motor = friction_after(s->motor, s->tau - transmitted(s), FsM);
    } else {
        int side = guard ? 1 : -1;
        s->gap = side * j0;
        s->contact = s->contact ? 0 : side;
        shaft_settle(s, 0.0);
    }
}

/* ---- integration ---- */

static double value(const Plant *p, int guard, const State *s, double torque, double h) {
    State end;
    Stride stride = p->stride(h);
    p->flow(s, torque, &stride, &end);
    return p->guard(guard, &end);
}

static double locate(const Plant *p, int guard, const State *s, double torque, double limit) {
    double near = 0.0, far = limit;
    double near_value = value(p, guard, s, torque, near), far_value = value(p, guard, s, torque, far);
    int kept = 0;
    if (near_value <= 0.0) {
        near = 1e-9 * limit;
        near_value = value(p, guard, s, torque, near);
        if (near_value <= 0.0) return near;
    }
    for (int trials = 0; trials < 100 && far - near > 1e-13 * limit; trials++) {
        double trial = far - far_value * (far - near) / (far_value - near_value);
        if (!(trial > near && trial < far)) trial = 0.5 * (near + far);
        double v = value(p, guard, s, torque, trial);
        if (v == 0.0) return trial;
        if (v < 0.0) {
            far = trial, far_value = v;
            if (kept == 1) near_value *= 0.5;
            kept = 1;
        } else {
            near = trial, near_value = v;
            if (kept == 2) far_value *= 0.5;
            kept = 2;
        }
    }
    return far;
}

static void with_events(const Plant *p, State *s, double torque, double h) {
    for (int events = 0; events < 64 && h > 0.0; events++) {
        State end;
        Stride stride = p->stride(h);
        p->flow(s, torque, &stride, &end);
        double first = INFINITY;
        int which = -1;
        for (int guard = 0; guard < p->guards; guard++) {
            if (p->guard(guard, &end) < 0.0) {
                double t = locate(p, guard, s, torque, h);
                if (t < first) first = t, which = guard;
            }
        }
        if (which < 0) {
            *s = end;
            return;
        }
        stride = p->stride(first);
        p->flow(s, torque, &stride, &end);
        *s = end;
        p->become(which, s);
        h -= first;
    }
}

/* Inlined into each plant's own loop, so that the compiler resolves the table of functions. */
static inline __attribute__((always_inline)) void period(const Plant *p, State *s, double torque) {
    const double h = 1e-3 / p->substeps;
    p->settle(s, torque);
    const Stride stride = p->stride(h);
    for (int i = 0; i < p->substeps; i++) {
        State end;
        int violated = 0;
        p->flow(s, torque, &stride, &end);
        for (int guard = 0; guard < p->guards; guard++) violated |= !(p->guard(guard, &end) >= 0.0);
        if (violated) with_events(p, s, torque, h);
        else *s = end;
    }
}

static const Plant SMOOTH_PLANT = {0, 4, plain_stride, smooth_flow, 0, 0, no_settle};
static const Plant HARD_PLANT = {3, 4, plain_stride, hard_flow, hard_guard, hard_become, hard_settle};
static const Plant SHAFT_PLANT = {4, 16, shaft_stride, shaft_flow, shaft_guard, shaft_become, shaft_settle};

/* Time of a clock in ns. */
static double clock_ns(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}
