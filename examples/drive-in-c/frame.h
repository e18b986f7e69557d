/* Frames: a body with its CRC, stuffed by COBS, ended by a zero byte. Section 2 of docs/protocol.md. */

#ifndef FRAME_H
#define FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "lashloop.h"

/* What a byte from the line has completed. */
enum received { RECEIVED_NOTHING, RECEIVED_BODY, RECEIVED_DAMAGE };

/* Collects bytes up to a delimiter. Zero-initialise. */
struct receiver {
    uint8_t bytes[LASHLOOP_MAX_FRAME]; /* the frame so far; the body after RECEIVED_BODY */
    size_t len;                        /* the same in bytes */
    int is_complete;                   /* the next byte begins a frame */
};

/* Takes one byte. After RECEIVED_BODY the body is in `bytes`, `len` long, until the next call. */
enum received receiver_take(struct receiver *receiver, uint8_t byte);

/* Makes a frame of a body; returns its length, delimiter included. */
size_t frame_of(const uint8_t *body, size_t len, uint8_t frame[LASHLOOP_MAX_FRAME]);

/* Fields: little endian, without alignment. */
uint32_t get_bits(const uint8_t *at, int bytes);
int32_t get_i24(const uint8_t *at);
float get_f32(const uint8_t *at);
void put_bits(uint8_t *at, uint32_t value, int bytes);
void put_f32(uint8_t *at, float value);

#endif
