#include "frame.h"

#include <string.h>

static uint32_t crc32c(const uint8_t *bytes, size_t len)
{
    uint32_t crc = LASHLOOP_CRC_INIT;
    for (size_t i = 0; i < len; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = (crc >> 1) ^ ((crc & 1u) ? LASHLOOP_CRC_POLYNOMIAL_REFLECTED : 0u);
    }
    return crc ^ LASHLOOP_CRC_XOROUT;
}

uint32_t get_bits(const uint8_t *at, int bytes)
{
    uint32_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint32_t)at[i] << (8 * i);
    return value;
}

void put_bits(uint8_t *at, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

int32_t get_i24(const uint8_t *at)
{
    int32_t bits = (int32_t)get_bits(at, 3);
    return bits < 0x800000 ? bits : bits - 0x1000000;
}

float get_f32(const uint8_t *at)
{
    uint32_t bits = get_bits(at, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

void put_f32(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_bits(at, bits, 4);
}

size_t frame_of(const uint8_t *body, size_t len, uint8_t frame[LASHLOOP_MAX_FRAME])
{
    memcpy(frame + 1, body, len);
    put_bits(frame + 1 + len, crc32c(body, len), LASHLOOP_CRC_LEN);
    size_t end = 1 + len + LASHLOOP_CRC_LEN;
    size_t code_at = 0;
    for (size_t at = 1; at < end; at++) {
        if (frame[at] == LASHLOOP_DELIMITER) {
            frame[code_at] = (uint8_t)(at - code_at);
            code_at = at;
        }
    }
    frame[code_at] = (uint8_t)(end - code_at);
    frame[end] = LASHLOOP_DELIMITER;
    return end + 1;
}

/* Replaces a frame without its delimiter by its body; returns 0 if the frame is damaged. */
static int unstuff(struct receiver *receiver)
{
    uint8_t *bytes = receiver->bytes;
    size_t end = receiver->len;
    size_t at = 0;
    /* A delimiter more than the bytes here. */
    if (end < LASHLOOP_OVERHEAD || end >= LASHLOOP_MAX_FRAME)
        return 0;
    while (at < end) {
        size_t distance = bytes[at];
        bytes[at] = 0;
        at += distance;
    }
    if (at != end)
        return 0;
    receiver->len = end + 1 - LASHLOOP_OVERHEAD;
    memmove(bytes, bytes + 1, end - 1);
    return crc32c(bytes, receiver->len) == get_bits(bytes + receiver->len, LASHLOOP_CRC_LEN);
}

enum received receiver_take(struct receiver *receiver, uint8_t byte)
{
    if (receiver->is_complete) {
        receiver->len = 0;
        receiver->is_complete = 0;
    }
    if (byte != LASHLOOP_DELIMITER) {
        /* A frame that is too long keeps a length that is too long. */
        if (receiver->len < LASHLOOP_MAX_FRAME)
            receiver->bytes[receiver->len++] = byte;
        return RECEIVED_NOTHING;
    }
    receiver->is_complete = 1;
    if (receiver->len == 0)
        return RECEIVED_NOTHING;
    return unstuff(receiver) ? RECEIVED_BODY : RECEIVED_DAMAGE;
}
