#include "safety.h"

void set_torque(struct drive *drive, float torque_nm)
{
    drive->torque_nm = torque_nm;
    drive->board->set_torque(torque_nm);
}

void rest(struct drive *drive, enum lashloop_state state)
{
    set_torque(drive, 0);
    drive->state = state;
}

/* The first fault is kept: what comes after it is usually its consequence. */
struct fault latch(struct drive *drive, uint8_t code, float value, float limit)
{
    struct fault fault = { code, drive->last_sequence, value, limit };
    rest(drive, LASHLOOP_STATE_FAULTED);
    if (!drive->has_fault)
        drive->fault = fault;
    drive->has_fault = 1;
    return fault;
}

/* A silence of exactly the limit is in time. */
int check_watchdog(struct drive *drive)
{
    uint64_t silence_ns = drive->board->now_ns() - drive->run.fed_at_ns;
    double limit_s = drive->run.values[WATCHDOG_US] * 1e-6;
    if (drive->state != LASHLOOP_STATE_RUNNING || (double)silence_ns <= drive->run.values[WATCHDOG_US] * 1e3)
        return 0;
    latch(drive, LASHLOOP_FAULT_CODE_WATCHDOG, (float)((double)silence_ns * 1e-9), (float)limit_s);
    return 1;
}
