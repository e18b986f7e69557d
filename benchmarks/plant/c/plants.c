/* The plants under a given torque. Reads lines "NAME PERIODS" and prints the time in ns and the final positions of load and
 * motor. */
#include "plants.h"

/* A triangle of +-2 N m every 2 s, exact in binary. */
static double push(long k) {
    long t = k % 2000;
    return (double)(t < 1000 ? t : 2000 - t) / 250.0 - 2.0;
}

int main(void) {
    char name[32];
    long periods;
    while (scanf("%31s %ld", name, &periods) == 2) {
        State s;
        memset(&s, 0, sizeof s);
        s.load = s.motor = FORWARDS;
        double from_ns = clock_ns(CLOCK_MONOTONIC);
        if (!strcmp(name, "smooth")) for (long k = 0; k < periods; k++) period(&SMOOTH_PLANT, &s, push(k));
        else if (!strcmp(name, "hard-coulomb")) for (long k = 0; k < periods; k++) period(&HARD_PLANT, &s, push(k));
        else if (!strcmp(name, "backlash-shaft")) for (long k = 0; k < periods; k++) period(&SHAFT_PLANT, &s, push(k));
        double ns = clock_ns(CLOCK_MONOTONIC) - from_ns;
        printf("%.17g %.17g %.17g\n", ns, s.x[LOAD], s.x[MOTOR]);
        fflush(stdout);
    }
    return 0;
}
