/* The decoder and encoder of codec.h, tested with golden frames.
 *
 * Reads one case per line from standard input, bytes as hexadecimal digits without spaces, reals as IEEE 754 bits:
 *
 *   frame  KIND NUMBER BODY_LENGTH FRAME                 decodes, and encodes to the same bytes
 *   bad    FRAME                                         is rejected
 *   sample FRAME SEQUENCE MOTOR LOAD REFERENCE           decodes to, and is encoded from, these values
 *   torque FRAME SEQUENCE TORQUE STATE FLAGS COMPUTE     the same
 *   values FRAME SEQUENCE COUNT VALUE...                 the same, of telemetry
 *   result FRAME NUMBER REQUEST OUTCOME STATE DETAIL HAS_TIME TIME
 *                                                        the same, of a CommandResult; further bytes may follow
 *   taken  SENDER VERDICT NUMBER FRAME                   is known, unknown or refused among the messages of a side
 *
 * The number is 0 where a kind has none.
 * Prints the number of passed cases. Exits with 1 at the first failed case.
 */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "codec.h"

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
    unsigned kind, number;
    size_t body_len;
    char digits[256];
    uint8_t body[LASHLOOP_MAX_FRAME];
    if (sscanf(line, "frame %u %u %zu %255s", &kind, &number, &body_len, digits) != 4)
        return false;
    struct bytes frame = from_hex(digits);
    return open_frame(frame.at, frame.len, body) == body_len && body[0] == kind
        && number_of(body, body_len) == number && is_known(body, body_len) && same_frame(body, body_len, &frame);
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
    if (len == 0 || body[0] != LASHLOOP_TELEMETRY_KIND || !is_known(body, len))
        return false;
    struct telemetry have = read_telemetry(body, len);
    memset(body, 0, sizeof body);
    return have.sequence == want.sequence && have.count == want.count
        && memcmp(have.values, want.values, want.count * sizeof want.values[0]) == 0
        && same_frame(body, write_telemetry(&want, body), &frame);
}

static bool result_case(const char *line)
{
    char digits[256];
    struct result want;
    uint8_t body[LASHLOOP_MAX_FRAME];
    unsigned has_time;
    int found = sscanf(line, "result %255s %" SCNu8 " %" SCNu8 " %" SCNu8 " %" SCNu8 " %" SCNu32 " %u %" SCNu32,
                       digits, &want.number, &want.request, &want.outcome, &want.state, &want.detail, &has_time,
                       &want.device_time_us);
    if (found != 8)
        return false;
    want.has_device_time = has_time != 0;
    struct bytes frame = from_hex(digits);
    size_t len = open_frame(frame.at, frame.len, body);
    if (len == 0 || body[0] != LASHLOOP_COMMAND_RESULT_KIND || !is_known(body, len))
        return false;
    struct result have = read_result(body, len);
    /* What follows the message is not read, and remains. */
    memset(body, 0, LASHLOOP_COMMAND_RESULT_SHORTEST_BODY_LEN);
    return have.number == want.number && have.request == want.request && have.outcome == want.outcome
        && have.state == want.state && have.detail == want.detail && have.has_device_time == want.has_device_time
        && (!have.has_device_time || have.device_time_us == want.device_time_us) && write_result(&want, body) <= len
        && same_frame(body, len, &frame);
}

static bool taken_case(const char *line)
{
    char sender[8], want[16], digits[256];
    unsigned number;
    uint8_t body[LASHLOOP_MAX_FRAME];
    if (sscanf(line, "taken %7s %15s %u %255s", sender, want, &number, digits) != 4)
        return false;
    struct bytes frame = from_hex(digits);
    size_t len = open_frame(frame.at, frame.len, body);
    if (len == 0)
        return false;
    const char *have = verdict(strcmp(sender, "drive") == 0, body, len);
    return strcmp(have, want) == 0 && (strcmp(have, "refused") == 0 || number_of(body, len) == number);
}

static bool passes(const char *line)
{
    static const struct { const char *name; bool (*passes)(const char *line); } CASES[] = {
        { "frame ", frame_case },   { "bad ", bad_case },       { "sample ", sample_case }, { "taken ", taken_case },
        { "torque ", torque_case }, { "values ", values_case }, { "result ", result_case },
    };
    for (size_t i = 0; i < COUNT_OF(CASES); i++) {
        if (strncmp(line, CASES[i].name, strlen(CASES[i].name)) == 0)
            return CASES[i].passes(line);
    }
    return false;
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
