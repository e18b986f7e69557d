/* The smooth plant of the paper as an FMU of FMI 1.0 and 2.0 (co-simulation and model exchange) and 3.0 (co-simulation), in one
 * library.
 *
 * `mode` is a start value that makes the FMU misbehave from its third step on:
 * 1 crashes, 2 hangs, 3 answers NaN, 4 discards the step, 5 fails with a message, 6 leaks, 7 prints to standard output,
 * 8 ends the simulation (FMI 3.0, model exchange of 2.0), 9 ignores `stiffness`, 10 refuses the torque after a warning in the step before,
 * 11 returns early (FMI 3.0), 12 has NaN as `stiffness`.
 * A step fails whose time isn't exactly that of the last one plus its step, or whose step isn't `only_step`, if that is set.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TORQUE, MOTOR, LOAD, TWIST, MODE, MOTOR_START, LOAD_START, DEAD_ZONE, STIFFNESS, ONLY_STEP, WET, NOTE, SUBSTEPS, LOAD_SPEED, MOTOR_SPEED, LOAD_ACCELERATION, MOTOR_ACCELERATION, REALS };

typedef struct {
    double real[REALS];
    double x[4]; /* load position and velocity, motor position and velocity */
    double time;
    int mode, wet, steps;
    char note[64];
    void (*log2)(void *, const char *, int, const char *, const char *, ...);
    void (*log3)(void *, int, const char *, const char *);
} Plant;

static void rates(const Plant *p, const double *x, double *dx) {
    double j0 = p->real[DEAD_ZONE], z = x[2] - 3.0 * x[0];
    double c = p->real[STIFFNESS] * (z - 4.0 * j0 * tanh(z / (4.0 * j0)));
    dx[0] = x[1];
    dx[1] = (3.0 * c - 16.0 * x[1]) / 7.5;
    dx[2] = x[3];
    dx[3] = (p->real[TORQUE] - c - 4.3e-4 * x[3]) / 9.72e-4;
}

static void runge_kutta(Plant *p, double h) {
    const double part[4] = {0.0, h / 2, h / 2, h};
    double k[5][4] = {{0}}, x[4];
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 4; i++) x[i] = p->x[i] + part[stage] * k[stage][i];
        rates(p, x, k[stage + 1]);
    }
    for (int i = 0; i < 4; i++) p->x[i] += h / 6 * (k[1][i] + 2 * k[2][i] + 2 * k[3][i] + k[4][i]);
}

static void say(Plant *p, int status, const char *message) {
    if (p->log2) p->log2(NULL, "plant", status, "all", "%s", message);
    if (p->log3) p->log3(NULL, status, "all", message);
}

static Plant *create(void) {
    Plant *p = calloc(1, sizeof *p);
    p->real[DEAD_ZONE] = 0.16;
    p->real[STIFFNESS] = 1.0;
    p->real[SUBSTEPS] = 4.0;
    return p;
}

static int step(Plant *p, double time, double h) {
    if (time != p->time) {
        say(p, 3, "the time isn't that of the last step");
        return 3;
    }
    if (p->real[ONLY_STEP] > 0.0 && h != p->real[ONLY_STEP]) {
        say(p, 2, "this step isn't the one it takes");
        return 2;
    }
    if (p->mode == 10) say(p, 1, "the belt is old");
    if (p->steps++ >= 2) {
        switch (p->mode) {
        case 1: *(volatile int *)8 = 1; break;
        case 2: for (;;) pause();
        case 3: p->x[2] = NAN; break;
        case 4: return 2;
        case 5: say(p, 3, "the belt slips"); return 3;
        case 6: { static void *volatile leaked; leaked = memset(malloc(1 << 20), 1, 1 << 20); break; }
        case 7: printf("step %d\n", p->steps); fflush(stdout); break;
        }
    }
    for (int i = 0; i < (int)p->real[SUBSTEPS]; i++) runge_kutta(p, h / p->real[SUBSTEPS]);
    /* As the bench computes it: a whole number of nanoseconds. */
    p->time = round((time + h) * 1e9) / 1e9;
    return 0;
}

static void get(Plant *p, const unsigned *vr, size_t n, double *values) {
    double dx[4];
    rates(p, p->x, dx);
    for (size_t i = 0; i < n; i++) {
        switch (vr[i]) {
        case MOTOR: values[i] = p->x[2]; break;
        case LOAD: values[i] = p->x[0]; break;
        case TWIST: values[i] = p->x[2] - 3.0 * p->x[0]; break;
        case LOAD_SPEED: values[i] = p->x[1]; break;
        case MOTOR_SPEED: values[i] = p->x[3]; break;
        case LOAD_ACCELERATION: values[i] = dx[1]; break;
        case MOTOR_ACCELERATION: values[i] = dx[3]; break;
        default: values[i] = p->real[vr[i]];
        }
    }
}

static void set(Plant *p, const unsigned *vr, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        if (p->mode == 9 && vr[i] == STIFFNESS) continue;
        p->real[vr[i]] = p->mode == 12 && vr[i] == STIFFNESS ? NAN : values[i];
        if (vr[i] == MOTOR_START) p->x[2] = values[i];
        if (vr[i] == LOAD_START) p->x[0] = values[i];
    }
}

/* FMI 2.0 */

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
} Callbacks;

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(Plant *p, int on, size_t n, const char *const *categories) { return 0; }
Plant *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const Callbacks *callbacks, int visible, int logging) {
    if (strcmp(guid, "plant-token") || strncmp(resources, "file:///", 8)) return NULL;
    callbacks->release(callbacks->allocate(1, 8));
    Plant *p = create();
    p->log2 = callbacks->logger;
    return p;
}
void fmi2FreeInstance(Plant *p) { free(p); }
int fmi2SetupExperiment(Plant *p, int has_tolerance, double tolerance, double start, int has_stop, double stop) { return 0; }
int fmi2EnterInitializationMode(Plant *p) { return 0; }
int fmi2ExitInitializationMode(Plant *p) { return 0; }
int fmi2Terminate(Plant *p) { return 0; }
int fmi2Reset(Plant *p) { return 3; }
int fmi2GetReal(Plant *p, const unsigned *vr, size_t n, double *values) { get(p, vr, n, values); return 0; }
int fmi2SetReal(Plant *p, const unsigned *vr, size_t n, const double *values) {
    if (p->mode == 10 && p->steps >= 2) return 3;
    set(p, vr, n, values);
    return 0;
}
int fmi2GetInteger(Plant *p, const unsigned *vr, size_t n, int *values) { *values = vr[0] == MODE ? p->mode : p->steps; return 0; }
int fmi2SetInteger(Plant *p, const unsigned *vr, size_t n, const int *values) { p->mode = *values; return 0; }
int fmi2GetBoolean(Plant *p, const unsigned *vr, size_t n, int *values) { *values = p->wet; return 0; }
int fmi2SetBoolean(Plant *p, const unsigned *vr, size_t n, const int *values) { p->wet = *values; return 0; }
int fmi2GetString(Plant *p, const unsigned *vr, size_t n, const char **values) { *values = p->note; return 0; }
int fmi2SetString(Plant *p, const unsigned *vr, size_t n, const char *const *values) { snprintf(p->note, sizeof p->note, "%s", *values); return 0; }
int fmi2DoStep(Plant *p, double time, double h, int no_set) { return step(p, time, h); }
int fmi2CancelStep(Plant *p) { return 3; }
#define NOT_OFFERED(name) int name(void) { return 3; }
NOT_OFFERED(fmi2GetFMUstate) NOT_OFFERED(fmi2SetFMUstate) NOT_OFFERED(fmi2FreeFMUstate)
NOT_OFFERED(fmi2SerializedFMUstateSize) NOT_OFFERED(fmi2SerializeFMUstate) NOT_OFFERED(fmi2DeSerializeFMUstate)
NOT_OFFERED(fmi2GetDirectionalDerivative) NOT_OFFERED(fmi2SetRealInputDerivatives) NOT_OFFERED(fmi2GetRealOutputDerivatives)
NOT_OFFERED(fmi2GetStatus) NOT_OFFERED(fmi2GetRealStatus) NOT_OFFERED(fmi2GetIntegerStatus) NOT_OFFERED(fmi2GetBooleanStatus)
NOT_OFFERED(fmi2GetStringStatus)

/* Model exchange */

typedef struct { int more, terminate, nominals, values, has_next; double next; } Events;
int fmi2EnterEventMode(Plant *p) { return 0; }
int fmi2NewDiscreteStates(Plant *p, Events *events) { memset(events, 0, sizeof *events); return 0; }
int fmi2EnterContinuousTimeMode(Plant *p) { return 0; }
int fmi2CompletedIntegratorStep(Plant *p, int no_set, int *event, int *terminate) { *event = 0; *terminate = p->mode == 8 && p->time > 2e-3; return 0; }
int fmi2SetTime(Plant *p, double time) { p->time = time; return 0; }
int fmi2SetContinuousStates(Plant *p, const double *x, size_t n) { memcpy(p->x, x, n * sizeof *x); return 0; }
int fmi2GetContinuousStates(Plant *p, double *x, size_t n) { memcpy(x, p->x, n * sizeof *x); return 0; }
int fmi2GetDerivatives(Plant *p, double *dx, size_t n) { rates(p, p->x, dx); return 0; }
int fmi2GetEventIndicators(Plant *p, double *z, size_t n) { return 0; }
int fmi2GetNominalsOfContinuousStates(Plant *p, double *x, size_t n) { for (size_t i = 0; i < n; i++) x[i] = 1.0; return 0; }

/* FMI 3.0 */

const char *fmi3GetVersion(void) { return "3.0"; }
Plant *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible, bool logging, bool events, bool early, const unsigned *vr, size_t n, void *environment, void (*log)(void *, int, const char *, const char *), void *update) {
    if (strcmp(token, "plant-token") || resources[strlen(resources) - 1] != '/') return NULL;
    Plant *p = create();
    p->log3 = log;
    return p;
}
void fmi3FreeInstance(Plant *p) { free(p); }
int fmi3EnterInitializationMode(Plant *p, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) { return 0; }
int fmi3ExitInitializationMode(Plant *p) { return 0; }
int fmi3Terminate(Plant *p) { return 0; }
int fmi3GetFloat64(Plant *p, const unsigned *vr, size_t n, double *values, size_t m) { get(p, vr, n, values); return 0; }
int fmi3SetFloat64(Plant *p, const unsigned *vr, size_t n, const double *values, size_t m) { set(p, vr, n, values); return 0; }
int fmi3GetFloat32(Plant *p, const unsigned *vr, size_t n, float *values, size_t m) { double x; get(p, vr, 1, &x); *values = (float)x; return 0; }
int fmi3GetInt32(Plant *p, const unsigned *vr, size_t n, int *values, size_t m) { *values = p->mode; return 0; }
int fmi3SetInt32(Plant *p, const unsigned *vr, size_t n, const int *values, size_t m) { p->mode = *values; return 0; }
int fmi3GetUInt64(Plant *p, const unsigned *vr, size_t n, unsigned long long *values, size_t m) { *values = p->steps; return 0; }
int fmi3GetBoolean(Plant *p, const unsigned *vr, size_t n, bool *values, size_t m) { *values = p->wet; return 0; }
int fmi3SetBoolean(Plant *p, const unsigned *vr, size_t n, const bool *values, size_t m) { p->wet = *values; return 0; }
int fmi3SetString(Plant *p, const unsigned *vr, size_t n, const char *const *values, size_t m) { snprintf(p->note, sizeof p->note, "%s", *values); return 0; }
int fmi3DoStep(Plant *p, double time, double h, bool no_set, bool *event, bool *terminate, bool *early, double *reached) {
    *event = false;
    *early = p->mode == 11 && p->steps >= 2;
    *terminate = p->mode == 8 && p->steps >= 2;
    *reached = *early ? time + h / 2 : time + h;
    return step(p, time, h);
}

/* FMI 1.0 */

typedef struct { void *logger, *allocate, *release; } ModelCallbacks;
typedef struct { void *logger, *allocate, *release, *finished; } SlaveCallbacks;
typedef struct { char converged, references, values, terminate, has_next; double next; } EventInfo;
const char *plant_fmiGetVersion(void) { return "1.0"; }
Plant *plant_fmiInstantiateModel(const char *name, const char *guid, ModelCallbacks callbacks, char logging) { return create(); }
void plant_fmiFreeModelInstance(Plant *p) { free(p); }
int plant_fmiEventUpdate(Plant *p, char intermediate, EventInfo *info) { *info = (EventInfo){.converged = 1}; return 0; }
int plant_fmiInitialize(Plant *p, char controlled, double tolerance, EventInfo *info) { return plant_fmiEventUpdate(p, 0, info); }
int plant_fmiCompletedIntegratorStep(Plant *p, char *event) { *event = 0; return 0; }
int plant_fmiSetTime(Plant *p, double time) { p->time = time; return 0; }
int plant_fmiSetContinuousStates(Plant *p, const double *x, size_t n) { return fmi2SetContinuousStates(p, x, n); }
int plant_fmiGetContinuousStates(Plant *p, double *x, size_t n) { return fmi2GetContinuousStates(p, x, n); }
int plant_fmiGetDerivatives(Plant *p, double *dx, size_t n) { return fmi2GetDerivatives(p, dx, n); }
int plant_fmiGetEventIndicators(Plant *p, double *z, size_t n) { return 0; }
int plant_fmiGetNominalContinuousStates(Plant *p, double *x, size_t n) { return fmi2GetNominalsOfContinuousStates(p, x, n); }
int plant_fmiTerminate(Plant *p) { return 0; }
Plant *plant_fmiInstantiateSlave(const char *name, const char *guid, const char *place, const char *mime, double timeout, char visible, char interactive, SlaveCallbacks callbacks, char logging) { return create(); }
void plant_fmiFreeSlaveInstance(Plant *p) { free(p); }
int plant_fmiInitializeSlave(Plant *p, double start, char has_stop, double stop) { return 0; }
int plant_fmiTerminateSlave(Plant *p) { return 0; }
int plant_fmiDoStep(Plant *p, double time, double h, char is_new) { return step(p, time, h); }
int plant_fmiGetReal(Plant *p, const unsigned *vr, size_t n, double *values) { get(p, vr, n, values); return 0; }
int plant_fmiSetReal(Plant *p, const unsigned *vr, size_t n, const double *values) { set(p, vr, n, values); return 0; }
NOT_OFFERED(plant_fmiCancelStep) NOT_OFFERED(plant_fmiGetBoolean) NOT_OFFERED(plant_fmiGetBooleanStatus)
NOT_OFFERED(plant_fmiGetInteger) NOT_OFFERED(plant_fmiGetIntegerStatus) NOT_OFFERED(plant_fmiGetModelTypesPlatform)
NOT_OFFERED(plant_fmiGetRealOutputDerivatives) NOT_OFFERED(plant_fmiGetRealStatus)
NOT_OFFERED(plant_fmiGetStateValueReferences) NOT_OFFERED(plant_fmiGetStatus) NOT_OFFERED(plant_fmiGetString)
NOT_OFFERED(plant_fmiGetStringStatus) NOT_OFFERED(plant_fmiGetTypesPlatform) NOT_OFFERED(plant_fmiResetSlave)
NOT_OFFERED(plant_fmiSetBoolean) NOT_OFFERED(plant_fmiSetDebugLogging) NOT_OFFERED(plant_fmiSetInteger)
NOT_OFFERED(plant_fmiSetRealInputDerivatives) NOT_OFFERED(plant_fmiSetString)
