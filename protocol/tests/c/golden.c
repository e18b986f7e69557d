/* A decoder and encoder written from docs/protocol.md and lashloop.h alone, tested with golden frames.
 *
 * Reads one case per line from standard input, bytes as hexadecimal digits without spaces, reals as IEEE 754 bits:
 *
 *   frame  KIND BODY_LENGTH FRAME                        decodes, and encodes to the same bytes
 *   bad    FRAME                                         is rejected
 *   sample FRAME SEQUENCE MOTOR LOAD REFERENCE           decodes to, and is encoded from, these values
 *   torque FRAME SEQUENCE TORQUE STATE FLAGS COMPUTE     the same
 *   values FRAME SEQUENCE COUNT VALUE...                 the same, of telemetry
 *   length KIND BODY_LENGTH                              isn't a length of this kind
 *
 * Prints the number of passed cases. Exits with 1 at the first failed case.
 */

#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lashloop.h"

_Static_assert(sizeof(float) == 4, "a float of this machine is not IEEE 754 binary32");
_Static_assert(LASHLOOP_MAX_BODY + LASHLOOP_OVERHEAD == LASHLOOP_MAX_FRAME, "lengths of the header");

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

/* ---- the bytes of a frame ---- */

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

/* ---- messages ---- */

#define ROW(name, kind, body_len, element_len) { kind, body_len, element_len },
static const struct { uint8_t kind; size_t body_len; size_t element_len; } MESSAGES[] = {
    LASHLOOP_HOST_MESSAGES(ROW) LASHLOOP_DRIVE_MESSAGES(ROW)
};

/* Whether a body of this kind may have this length. Telemetry is the one kind whose last field repeats. */
static bool is_body_len(uint8_t kind, size_t len)
{
    for (size_t i = 0; i < COUNT_OF(MESSAGES); i++) {
        if (MESSAGES[i].kind != kind)
            continue;
        if (MESSAGES[i].element_len == 0)
            return len == MESSAGES[i].body_len;
        return len > LASHLOOP_TELEMETRY_VALUES_OFFSET && len <= MESSAGES[i].body_len
            && (len - LASHLOOP_TELEMETRY_VALUES_OFFSET) % MESSAGES[i].element_len == 0;
    }
    return false;
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

/* The length is that of a telemetry body, which is_body_len has checked. */
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

/* ---- cases ---- */

struct bytes {
    uint8_t at[4 * LASHLOOP_MAX_FRAME];
    size_t len;
};

static struct bytes from_hex(const char *digits)
{
    struct bytes bytes = { .len = 0 };
    unsigned byte;
    while (bytes.len < COUNT_OF(bytes.at) && sscanf(digits, "%2x", &byte) == 1) {
        bytes.at[bytes.len++] = (uint8_t)byte;
        digits += 2;
    }
    return bytes;
}

static bool same_frame(const uint8_t *body, size_t body_len, const struct bytes *want)
{
    uint8_t frame[LASHLOOP_MAX_FRAME];
    size_t len = close_frame(body, body_len, frame);
    return len == want->len && memcmp(frame, want->at, len) == 0;
}

static float float_of(uint32_t bits)
{
    uint8_t bytes[4];
    put_u32(bytes, bits);
    return get_f32(bytes);
}

static bool frame_case(const char *line)
{
    unsigned kind;
    size_t body_len;
    char digits[256];
    uint8_t body[LASHLOOP_MAX_FRAME];
    if (sscanf(line, "frame %u %zu %255s", &kind, &body_len, digits) != 3)
        return false;
    struct bytes frame = from_hex(digits);
    return open_frame(frame.at, frame.len, body) == body_len && body[0] == kind
        && is_body_len(body[0], body_len) && same_frame(body, body_len, &frame);
}

static bool bad_case(const char *line)
{
    char digits[256];
    uint8_t body[LASHLOOP_MAX_FRAME];
    if (sscanf(line, "bad %255s", digits) != 1)
        return false;
    struct bytes frame = from_hex(digits);
    return open_frame(frame.at, frame.len, body) == 0;
}

static bool sample_case(const char *line)
{
    char digits[256];
    uint32_t reference;
    struct sample want;
    uint8_t body[LASHLOOP_MAX_FRAME];
    int found = sscanf(line, "sample %255s %" SCNu16 " %" SCNd32 " %" SCNd32 " %" SCNx32, digits, &want.sequence,
                       &want.motor_counts, &want.load_counts, &reference);
    if (found != 5)
        return false;
    want.reference_rad = float_of(reference);
    struct bytes frame = from_hex(digits);
    if (open_frame(frame.at, frame.len, body) != LASHLOOP_ENCODER_SAMPLE_BODY_LEN
        || body[0] != LASHLOOP_ENCODER_SAMPLE_KIND)
        return false;
    struct sample have = read_sample(body);
    memset(body, 0, sizeof body);
    return have.sequence == want.sequence && have.motor_counts == want.motor_counts
        && have.load_counts == want.load_counts && have.reference_rad == want.reference_rad
        && same_frame(body, write_sample(&want, body), &frame);
}

static bool torque_case(const char *line)
{
    char digits[256];
    uint32_t torque;
    struct torque want;
    uint8_t body[LASHLOOP_MAX_FRAME];
    int found = sscanf(line, "torque %255s %" SCNu16 " %" SCNx32 " %" SCNu8 " %" SCNu8 " %" SCNu16, digits,
                       &want.sequence, &torque, &want.state, &want.flags, &want.compute_tenths_us);
    if (found != 6)
        return false;
    want.torque_nm = float_of(torque);
    struct bytes frame = from_hex(digits);
    if (open_frame(frame.at, frame.len, body) != LASHLOOP_TORQUE_ANSWER_BODY_LEN
        || body[0] != LASHLOOP_TORQUE_ANSWER_KIND)
        return false;
    struct torque have = read_torque(body);
    memset(body, 0, sizeof body);
    return have.sequence == want.sequence && have.torque_nm == want.torque_nm && have.state == want.state
        && have.flags == want.flags && have.compute_tenths_us == want.compute_tenths_us
        && same_frame(body, write_torque(&want, body), &frame);
}

static bool values_case(const char *line)
{
    char digits[256];
    struct telemetry want;
    uint8_t body[LASHLOOP_MAX_FRAME];
    int used = 0;
    if (sscanf(line, "values %255s %" SCNu16 " %zu%n", digits, &want.sequence, &want.count, &used) != 3
        || want.count > COUNT_OF(want.values))
        return false;
    for (size_t i = 0; i < want.count; i++) {
        uint32_t bits;
        int more = 0;
        if (sscanf(line + used, " %" SCNx32 "%n", &bits, &more) != 1)
            return false;
        want.values[i] = float_of(bits);
        used += more;
    }
    struct bytes frame = from_hex(digits);
    size_t len = open_frame(frame.at, frame.len, body);
    if (len == 0 || body[0] != LASHLOOP_TELEMETRY_KIND || !is_body_len(body[0], len))
        return false;
    struct telemetry have = read_telemetry(body, len);
    memset(body, 0, sizeof body);
    return have.sequence == want.sequence && have.count == want.count
        && memcmp(have.values, want.values, want.count * sizeof want.values[0]) == 0
        && same_frame(body, write_telemetry(&want, body), &frame);
}

static bool length_case(const char *line)
{
    unsigned kind;
    size_t len;
    return sscanf(line, "length %u %zu", &kind, &len) == 2 && !is_body_len((uint8_t)kind, len);
}

static bool passes(const char *line)
{
    switch (line[0]) {
    case 'f': return frame_case(line);
    case 'b': return bad_case(line);
    case 's': return sample_case(line);
    case 't': return torque_case(line);
    case 'v': return values_case(line);
    case 'l': return length_case(line);
    default: return false;
    }
}

int main(void)
{
    if (crc32c((const uint8_t *)"123456789", 9) != LASHLOOP_CRC_CHECK) {
        fputs("the CRC of \"123456789\" is not the header's\n", stderr);
        return EXIT_FAILURE;
    }
    char line[1024];
    unsigned passed = 0;
    for (; fgets(line, sizeof line, stdin); passed++) {
        if (!passes(line)) {
            fprintf(stderr, "failed: %s", line);
            return EXIT_FAILURE;
        }
    }
    printf("%u\n", passed);
    return EXIT_SUCCESS;
}
