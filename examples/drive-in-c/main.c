/* The drive on standard input and output. On a board, these are the UART, a timer and the power stage. */

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "drive.h"

static uint64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void send_frame(const uint8_t *bytes, size_t len)
{
    while (len > 0) {
        ssize_t count = write(STDOUT_FILENO, bytes, len);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            exit(0); /* the bench has closed the line */
        bytes += count;
        len -= (size_t)count;
    }
}

static void set_torque(float torque_nm)
{
    (void)torque_nm; /* no power stage here: the bench simulates the motor */
}

int main(void)
{
    static const struct board BOARD = { now_ns, send_frame, set_torque };
    static struct drive drive;
    struct pollfd input = { .fd = STDIN_FILENO, .events = POLLIN };
    uint8_t bytes[256];
    drive_init(&drive, &BOARD);
    for (;;) {
        /* Only a running drive has a watchdog to serve. */
        poll(&input, 1, drive.state == LASHLOOP_STATE_RUNNING ? 1 : -1);
        if (input.revents) {
            ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
            if (count == 0)
                return 0;
            for (ssize_t i = 0; i < count; i++)
                drive_receive(&drive, bytes[i]);
        }
        drive_tick(&drive);
    }
}
