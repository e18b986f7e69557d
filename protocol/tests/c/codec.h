/* A decoder and encoder written from docs/protocol.md and lashloop.h alone. */

#ifndef CODEC_H
#define CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "lashloop.h"

_Static_assert(sizeof(float) == 4, "a float of this machine is not IEEE 754 binary32");
_Static_assert(LASHLOOP_MAX_BODY + LASHLOOP_OVERHEAD == LASHLOOP_MAX_FRAME, "lengths of the header");

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

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

static uint32_t get_u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static void put_u32(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> (8 * i));
}

static uint16_t get_u16(const uint8_t *at)
{
    return (uint16_t)(at[0] | at[1] << 8);
}

static void put_u16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

/* Counts are 24 bits; the highest is the sign. */
static int32_t get_i24(const uint8_t *at)
{
    int32_t bits = (int32_t)at[0] | (int32_t)at[1] << 8 | (int32_t)at[2] << 16;
    return bits < 0x800000 ? bits : bits - 0x1000000;
}

/* Takes any count modulo 2^24. */
static void put_i24(uint8_t *at, int32_t value)
{
    uint32_t bits = (uint32_t)value;
    for (int i = 0; i < 3; i++)
        at[i] = (uint8_t)(bits >> (8 * i));
}

static float get_f32(const uint8_t *at)
{
    uint32_t bits = get_u32(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void put_f32(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(at, bits);
}

/* Makes a frame of a body; returns its length, delimiter included. */
static size_t close_frame(const uint8_t *body, size_t len, uint8_t frame[LASHLOOP_MAX_FRAME])
{
    memcpy(frame + 1, body, len);
    put_u32(frame + 1 + len, crc32c(body, len));
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

/* Extracts the body of a frame with its delimiter; returns its length, or 0 if the frame is damaged. */
static size_t open_frame(const uint8_t *frame, size_t len, uint8_t body[LASHLOOP_MAX_FRAME])
{
    if (len <= LASHLOOP_OVERHEAD || len > LASHLOOP_MAX_FRAME || frame[len - 1] != LASHLOOP_DELIMITER)
        return 0;
    uint8_t bytes[LASHLOOP_MAX_FRAME];
    memcpy(bytes, frame, len);
    size_t end = len - 1;
    size_t at = 0;
    while (at < end) {
        size_t distance = bytes[at];
        if (distance == 0)
            return 0;
        bytes[at] = 0;
        at += distance;
    }
    if (at != end)
        return 0;
    size_t body_len = len - LASHLOOP_OVERHEAD;
    if (crc32c(bytes + 1, body_len) != get_u32(bytes + 1 + body_len))
        return 0;
    memcpy(body, bytes + 1, body_len);
    return body_len;
}

struct kind {
    uint8_t kind;
    size_t shortest, longest, element_len;
};
#define ROW(name, kind, shortest, longest, element_len) { kind, shortest, longest, element_len },
static const struct kind HOST[] = { LASHLOOP_HOST_MESSAGES(ROW) };
static const struct kind DRIVE[] = { LASHLOOP_DRIVE_MESSAGES(ROW) };

/* Whether a body of this kind may have this length. A newer side may have added fields. */
static bool is_body_len(const struct kind *kind, size_t len)
{
    if (kind->element_len == 0)
        return len >= kind->shortest;
    return len >= kind->shortest && len <= kind->longest && (len - kind->shortest) % kind->element_len == 0;
}

/* What a receiver of the messages of one side makes of a body, as far as kind and length decide it. */
static const char *verdict(bool is_from_drive, const uint8_t *body, size_t len)
{
    const struct kind *kinds = is_from_drive ? DRIVE : HOST;
    size_t count = is_from_drive ? COUNT_OF(DRIVE) : COUNT_OF(HOST);
    /* The highest bit is the side; the others are never all zero. */
    if ((body[0] >= 0x80) != is_from_drive || (body[0] & 0x7f) == 0)
        return "refused";
    for (size_t i = 0; i < count; i++) {
        if (kinds[i].kind == body[0])
            return is_body_len(&kinds[i], len) ? "known" : "refused";
    }
    return "unknown";
}

static bool is_known(const uint8_t *body, size_t len)
{
    return strcmp(verdict(body[0] >= 0x80, body, len), "known") == 0;
}

static uint8_t number_of(const uint8_t *body, size_t len)
{
    return LASHLOOP_HAS_NUMBER(body[0]) && len > LASHLOOP_NUMBER_OFFSET ? body[LASHLOOP_NUMBER_OFFSET] : 0;
}

struct sample {
    uint16_t sequence;
    int32_t motor_counts;
    int32_t load_counts;
    float reference_rad;
};

static struct sample read_sample(const uint8_t *body)
{
    return (struct sample){
        .sequence = get_u16(body + LASHLOOP_ENCODER_SAMPLE_SEQUENCE_OFFSET),
        .motor_counts = get_i24(body + LASHLOOP_ENCODER_SAMPLE_MOTOR_COUNTS_OFFSET),
        .load_counts = get_i24(body + LASHLOOP_ENCODER_SAMPLE_LOAD_COUNTS_OFFSET),
        .reference_rad = get_f32(body + LASHLOOP_ENCODER_SAMPLE_REFERENCE_RAD_OFFSET),
    };
}

static size_t write_sample(const struct sample *sample, uint8_t *body)
{
    body[0] = LASHLOOP_ENCODER_SAMPLE_KIND;
    put_u16(body + LASHLOOP_ENCODER_SAMPLE_SEQUENCE_OFFSET, sample->sequence);
    put_i24(body + LASHLOOP_ENCODER_SAMPLE_MOTOR_COUNTS_OFFSET, sample->motor_counts);
    put_i24(body + LASHLOOP_ENCODER_SAMPLE_LOAD_COUNTS_OFFSET, sample->load_counts);
    put_f32(body + LASHLOOP_ENCODER_SAMPLE_REFERENCE_RAD_OFFSET, sample->reference_rad);
    return LASHLOOP_ENCODER_SAMPLE_BODY_LEN;
}

struct torque {
    uint16_t sequence;
    float torque_nm;
    uint8_t state;
    uint8_t flags;
    uint16_t compute_tenths_us;
};

static struct torque read_torque(const uint8_t *body)
{
    uint8_t status = body[LASHLOOP_TORQUE_ANSWER_STATUS_OFFSET];
    return (struct torque){
        .sequence = get_u16(body + LASHLOOP_TORQUE_ANSWER_SEQUENCE_OFFSET),
        .torque_nm = get_f32(body + LASHLOOP_TORQUE_ANSWER_TORQUE_NM_OFFSET),
        .state = status & LASHLOOP_STATUS_STATE_MASK,
        .flags = status & (uint8_t)~LASHLOOP_STATUS_STATE_MASK,
        .compute_tenths_us = get_u16(body + LASHLOOP_TORQUE_ANSWER_COMPUTE_TENTHS_US_OFFSET),
    };
}

struct telemetry {
    uint16_t sequence;
    size_t count;
    float values[LASHLOOP_MAX_TELEMETRY_VALUES];
};

/* The length is that of a telemetry body, which is_known has checked. */
static struct telemetry read_telemetry(const uint8_t *body, size_t len)
{
    struct telemetry telemetry = {
        .sequence = get_u16(body + LASHLOOP_TELEMETRY_SEQUENCE_OFFSET),
        .count = (len - LASHLOOP_TELEMETRY_VALUES_OFFSET) / LASHLOOP_TELEMETRY_VALUES_ELEMENT_LEN,
    };
    const uint8_t *at = body + LASHLOOP_TELEMETRY_VALUES_OFFSET;
    for (size_t i = 0; i < telemetry.count; i++, at += LASHLOOP_TELEMETRY_VALUES_ELEMENT_LEN)
        telemetry.values[i] = get_f32(at);
    return telemetry;
}

static size_t write_telemetry(const struct telemetry *telemetry, uint8_t *body)
{
    body[0] = LASHLOOP_TELEMETRY_KIND;
    put_u16(body + LASHLOOP_TELEMETRY_SEQUENCE_OFFSET, telemetry->sequence);
    size_t len = LASHLOOP_TELEMETRY_VALUES_OFFSET;
    for (size_t i = 0; i < telemetry->count; i++, len += LASHLOOP_TELEMETRY_VALUES_ELEMENT_LEN)
        put_f32(body + len, telemetry->values[i]);
    return len;
}

static size_t write_torque(const struct torque *torque, uint8_t *body)
{
    body[0] = LASHLOOP_TORQUE_ANSWER_KIND;
    put_u16(body + LASHLOOP_TORQUE_ANSWER_SEQUENCE_OFFSET, torque->sequence);
    put_f32(body + LASHLOOP_TORQUE_ANSWER_TORQUE_NM_OFFSET, torque->torque_nm);
    body[LASHLOOP_TORQUE_ANSWER_STATUS_OFFSET] = torque->state | torque->flags;
    put_u16(body + LASHLOOP_TORQUE_ANSWER_COMPUTE_TENTHS_US_OFFSET, torque->compute_tenths_us);
    return LASHLOOP_TORQUE_ANSWER_BODY_LEN;
}

struct result {
    uint8_t number, request, outcome, state;
    uint32_t detail, device_time_us;
    bool has_device_time;
};

static struct result read_result(const uint8_t *body, size_t len)
{
    struct result result = {
        .number = number_of(body, len),
        .request = body[LASHLOOP_COMMAND_RESULT_REQUEST_OFFSET],
        .outcome = body[LASHLOOP_COMMAND_RESULT_OUTCOME_OFFSET],
        .state = body[LASHLOOP_COMMAND_RESULT_STATE_OFFSET],
        .detail = get_u32(body + LASHLOOP_COMMAND_RESULT_DETAIL_OFFSET),
        .has_device_time = len >= LASHLOOP_COMMAND_RESULT_BODY_LEN,
    };
    if (result.has_device_time)
        result.device_time_us = get_u32(body + LASHLOOP_COMMAND_RESULT_DEVICE_TIME_US_OFFSET);
    return result;
}

static size_t write_result(const struct result *result, uint8_t *body)
{
    body[0] = LASHLOOP_COMMAND_RESULT_KIND;
    body[LASHLOOP_NUMBER_OFFSET] = result->number;
    body[LASHLOOP_COMMAND_RESULT_REQUEST_OFFSET] = result->request;
    body[LASHLOOP_COMMAND_RESULT_OUTCOME_OFFSET] = result->outcome;
    body[LASHLOOP_COMMAND_RESULT_STATE_OFFSET] = result->state;
    put_u32(body + LASHLOOP_COMMAND_RESULT_DETAIL_OFFSET, result->detail);
    if (!result->has_device_time)
        return LASHLOOP_COMMAND_RESULT_SHORTEST_BODY_LEN;
    put_u32(body + LASHLOOP_COMMAND_RESULT_DEVICE_TIME_US_OFFSET, result->device_time_us);
    return LASHLOOP_COMMAND_RESULT_BODY_LEN;
}

#endif
