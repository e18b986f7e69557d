-- Wireshark dissector for the line between a Lashloop bench and a drive, protocol version 1.
--
-- Reads captures with link type USER0 (147), one frame a packet, as `lashloop run --capture FILE.pcapng` writes them:
--
--   tshark -X lua_script:lashloop.lua -r FILE.pcapng
--   wireshark -X lua_script:lashloop.lua FILE.pcapng       or copy it to ~/.local/lib/wireshark/plugins
--
-- A frame is COBS( kind, fields, CRC-32C of both ) and a zero byte; numbers are little endian. The tables below follow
-- the layouts of the crate lashloop-protocol; a test holds them against each other.
--
-- Filters: lashloop.kind == 0x90, lashloop.sequence == 12, lashloop.state == 5, lashloop.status.state == 5,
-- lashloop.status.gap == 1, lashloop.crc.status == 0. A sequence has 16 bits and begins anew after 65535.

local lashloop = Proto("lashloop", "Lashloop bench and drive")

local LONGEST_FRAME = 64
local CRC_LENGTH = 4

-- Closed lists of names ------------------------------------------------------------------------------------------

local STATE = { [1] = "Boot", [2] = "Idle", [3] = "Armed", [4] = "Running", [5] = "Faulted" }
local FAULT_CODE = {
    [1] = "Watchdog", [2] = "EmergencyStop", [3] = "TorqueNotFinite", [4] = "ReferenceNotFinite",
    [5] = "MotorEncoderJump", [6] = "LoadEncoderJump", [7] = "Panic", [8] = "ProcessorFault",
}
local OUTCOME = {
    [1] = "Accepted", [2] = "WrongState", [3] = "WrongSession", [4] = "VersionMismatch", [5] = "UnknownParameter",
    [6] = "WrongType", [7] = "OutOfRange", [8] = "OutOfSequence", [9] = "Inconsistent",
}
local LOG_LEVEL = { [1] = "Debug", [2] = "Info", [3] = "Warning", [4] = "Error" }
local PARAMETER_TYPE = { [1] = "U32", [2] = "F32" }
local TORQUE_FLAGS = { [16] = "SATURATED", [32] = "REPEATED", [64] = "GAP" }
-- The bits of a status that are its state; the others are flags.
local STATE_MASK = 0x0f
local CONTROLLERS = { [2] = "PD", [4] = "MERZOUKI", [8] = "MERZOUKI_AS_PRINTED", [16] = "BACKLASH_INVERSE" }

-- Types of fields: how many bytes, and how to read and show them ---------------------------------------------------

local u8, u16, u32 = { len = 1, new = ProtoField.uint8 }, { len = 2, new = ProtoField.uint16 },
    { len = 4, new = ProtoField.uint32 }
-- Wireshark shows a float with six digits and a double with enough to read the float back, so reals are doubles here.
local i24, f32 = { len = 3, new = ProtoField.int24 }, { len = 4, new = ProtoField.double, is_real = true }
local value, version = { len = 5, is_value = true }, { len = 3, is_version = true }

local function enum(names) return { len = 1, new = ProtoField.uint8, names = names } end
local function flags(len, names)
    return { len = len, new = len == 1 and ProtoField.uint8 or ProtoField.uint16, flags = names }
end
local function status(states, torque_flags)
    return { len = 1, new = ProtoField.uint8, states = states, flags = torque_flags }
end
local function text(len) return { len = len, is_text = true } end

-- Messages: kind, name, fields in the order of their bytes ----------------------------------------------------------

local MESSAGES = {
    [0x01] = { "Hello", {
        { "protocol_version", u8 },
        { "session", u32 },
    } },
    [0x02] = { "DescribeParameter", {
        { "index", u8 },
    } },
    [0x03] = { "GetParameter", {
        { "index", u8 },
    } },
    [0x04] = { "SetParameter", {
        { "index", u8 },
        { "value", value },
    } },
    [0x05] = { "Arm", {
        { "session", u32 },
    } },
    [0x06] = { "Start", {
        { "session", u32 },
    } },
    [0x07] = { "Stop", {} },
    [0x08] = { "EmergencyStop", {} },
    [0x09] = { "ClearFault", {} },
    [0x0a] = { "Reset", {} },
    [0x10] = { "EncoderSample", {
        { "sequence", u16 },
        { "motor_counts", i24 },
        { "load_counts", i24 },
        { "reference_rad", f32 },
    } },
    [0x81] = { "Identity", {
        { "protocol_version", u8 },
        { "session", u32 },
        { "firmware", version },
        { "build_id", u32 },
        { "state", enum(STATE) },
        { "board", text(16) },
        { "period_us", u32 },
        { "motor_counts_per_rev", u32 },
        { "load_counts_per_rev", u32 },
        { "controllers", flags(2, CONTROLLERS) },
        { "parameter_count", u8 },
    } },
    [0x82] = { "ParameterDescription", {
        { "index", u8 },
        { "live", u8 },
        { "default", value },
        { "min", value },
        { "max", value },
        { "name", text(28) },
        { "unit", text(10) },
    } },
    [0x83] = { "ParameterReport", {
        { "index", u8 },
        { "outcome", enum(OUTCOME) },
        { "value", value },
        { "state", enum(STATE) },
    } },
    [0x85] = { "CommandResult", {
        { "request", u8 },
        { "outcome", enum(OUTCOME) },
        { "state", enum(STATE) },
    } },
    [0x90] = { "TorqueAnswer", {
        { "sequence", u16 },
        { "torque_nm", f32 },
        { "status", status(STATE, TORQUE_FLAGS) },
        { "compute_tenths_us", u16 },
    } },
    [0x91] = { "Telemetry", {
        { "sequence", u16 },
        { "dead_zone_estimate_rad", f32 },
        { "disturbing_torque_nm", f32 },
        { "load_error_rad", f32 },
        { "motor_error_rad", f32 },
        { "elastic_error_nm", f32 },
        { "requested_torque_nm", f32 },
    } },
    [0x92] = { "FaultReport", {
        { "code", enum(FAULT_CODE) },
        { "sequence", u16 },
        { "value", f32 },
        { "limit", f32 },
        { "detail", u32 },
    } },
    [0x93] = { "Log", {
        { "level", enum(LOG_LEVEL) },
        { "text", text(52) },
    } },
    [0x94] = { "LineReport", {
        { "messages", u32 },
        { "damaged", u32 },
        { "refused", u32 },
        { "overruns", u32 },
    } },
}

local KIND_NAMES = {}
for kind, message in pairs(MESSAGES) do KIND_NAMES[kind] = message[1] end

-- Units, by the end of a field's name
local UNITS = {
    { "_counts_per_rev$", "counts per revolution" }, { "_counts$", "counts" }, { "_tenths_us$", "0.1 us" },
    { "_us$", "us" }, { "_nm$", "N m" }, { "_rad$", "rad" },
}
local function unit_of(name)
    for _, unit in ipairs(UNITS) do
        if name:find(unit[1]) then return (unit[2]:find("^%d") and " x " or " ") .. unit[2] end
    end
    return ""
end

-- Fields for filters: lashloop.NAME; a parameter's value is lashloop.NAME.type with lashloop.NAME.u32 or .f32, a flag is
-- lashloop.FIELD.flag. Fields of one name and type are one filter, whatever message they are in. --------------------

local fields = {
    kind = ProtoField.uint8("lashloop.kind", "kind", base.HEX, KIND_NAMES),
    crc = ProtoField.uint32("lashloop.crc", "crc", base.HEX),
    crc_status = ProtoField.uint8("lashloop.crc.status", "crc status", base.DEC, { [0] = "Bad", [1] = "Good" }),
    stuffed = ProtoField.bytes("lashloop.stuffed", "frame on the wire"),
}

local function add_fields(name, ty)
    local abbreviation = "lashloop." .. name
    local function add(key, make)
        if not fields[key] then fields[key] = make() end
    end
    if ty.is_value then
        add(name .. ".type", function()
            return ProtoField.uint8(abbreviation .. ".type", name .. " type", base.DEC, PARAMETER_TYPE)
        end)
        add(name .. ".u32", function() return ProtoField.uint32(abbreviation .. ".u32", name) end)
        add(name .. ".f32", function() return ProtoField.double(abbreviation .. ".f32", name) end)
    elseif ty.is_text or ty.is_version then
        add(name, function() return ProtoField.string(abbreviation, name) end)
    elseif ty.names then
        add(name, function() return ty.new(abbreviation, name, base.DEC, ty.names) end)
    elseif ty.flags then
        add(name, function() return ty.new(abbreviation, name, base.HEX) end)
        if ty.states then
            add(name .. ".state", function()
                return ty.new(abbreviation .. ".state", "state", base.DEC, ty.states, STATE_MASK)
            end)
        end
        for mask, flag in pairs(ty.flags) do
            add(name .. "." .. flag, function()
                return ProtoField.bool(abbreviation .. "." .. flag:lower(), flag, 8 * ty.len, nil, mask)
            end)
        end
    else
        add(name, function() return ty.new(abbreviation, name) end)
    end
end

for _, message in pairs(MESSAGES) do
    for _, field in ipairs(message[2]) do add_fields(field[1], field[2]) end
end

local declared = {}
for _, field in pairs(fields) do declared[#declared + 1] = field end
lashloop.fields = declared

local experts = {
    crc = ProtoExpert.new("lashloop.crc.bad", "CRC is wrong", expert.group.CHECKSUM, expert.severity.ERROR),
    malformed = ProtoExpert.new("lashloop.malformed", "Not a frame", expert.group.MALFORMED, expert.severity.ERROR),
    unknown = ProtoExpert.new("lashloop.unknown", "Not a message of protocol version 1", expert.group.UNDECODED,
        expert.severity.WARN),
    fault = ProtoExpert.new("lashloop.fault", "The drive latched a fault", expert.group.RESPONSE_CODE,
        expert.severity.WARN),
}
lashloop.experts = { experts.crc, experts.malformed, experts.unknown, experts.fault }

-- CRC-32C: reflected polynomial 0x82f63b78, initial value and final xor 0xffffffff ---------------------------------

-- Wireshark 4.2 and older have Lua 5.2 with bit32, newer ones Lua 5.4 with operators that 5.2 can't parse.
local bxor = bit32 and bit32.bxor or load("return function(a, b) return a ~ b end")()

local CRC_TABLE = {}
for byte = 0, 255 do
    local remainder = byte
    for _ = 1, 8 do
        local odd = remainder % 2 == 1
        remainder = math.floor(remainder / 2)
        if odd then remainder = bxor(remainder, 0x82f63b78) end
    end
    CRC_TABLE[byte] = remainder
end

local function crc32c(bytes)
    local crc = 0xffffffff
    for at = 1, #bytes do
        local index = bxor(crc % 256, bytes:byte(at))
        crc = bxor(math.floor(crc / 256), CRC_TABLE[index])
    end
    return bxor(crc, 0xffffffff)
end

-- COBS: `stuffed` is what stands before the delimiter; nil if the chain does not end at its end -----------------------

local function unstuff(stuffed)
    local parts, at = {}, 1
    while at <= #stuffed do
        local distance = stuffed:byte(at)
        if distance == 0 or at + distance > #stuffed + 1 then return nil end
        parts[#parts + 1] = stuffed:sub(at + 1, at + distance - 1)
        at = at + distance
    end
    return table.concat(parts, "\0")
end

-- One field into the tree; gives what the info column says of it ------------------------------------------------------

local function zero_padded(range) return (range:raw():gsub("%z.*", "")) end

local function show_value(tree, name, range)
    local ty = range(0, 1):uint()
    if not PARAMETER_TYPE[ty] then return nil end
    tree:add(fields[name .. ".type"], range(0, 1))
    local bytes = range(1, 4)
    if ty == 1 then
        tree:add_le(fields[name .. ".u32"], bytes)
        return tostring(bytes:le_uint())
    end
    tree:add(fields[name .. ".f32"], bytes, bytes:le_float())
    return string.format("%.4g", bytes:le_float())
end

local function show_flags(tree, name, ty, range)
    local branch = tree:add_le(fields[name], range)
    local bits, set, known = range:le_uint(), {}, 0
    if ty.states then
        branch:add(fields[name .. ".state"], range)
        local state = ty.states[bits % (STATE_MASK + 1)]
        if not state then return nil end
        set[1], known = state, bits % (STATE_MASK + 1)
    end
    for bit = 0, 8 * ty.len - 1 do
        local flag = ty.flags[2 ^ bit]
        if flag then
            branch:add_le(fields[name .. "." .. flag], range)
            if math.floor(bits / 2 ^ bit) % 2 == 1 then
                set[#set + 1] = flag
                known = known + 2 ^ bit
            end
        end
    end
    branch:append_text(" (" .. (#set > 0 and table.concat(set, "|") or "none") .. ")")
    -- Laws that a newer drive may offer have no name here; a torque with an unknown flag is no torque.
    if ty.len == 1 and known ~= bits then return nil end
    return table.concat(set, "|")
end

-- nil if the bytes are no value of the type
local function show_field(tree, field, range)
    local name, ty = field[1], field[2]
    if ty.is_value then return show_value(tree, name, range) end
    if ty.flags then return show_flags(tree, name, ty, range) end
    if ty.is_text then
        tree:add(fields[name], range, zero_padded(range))
        return zero_padded(range)
    end
    if ty.is_version then
        local text = string.format("%d.%d.%d", range(0, 1):uint(), range(1, 1):uint(), range(2, 1):uint())
        tree:add(fields[name], range, text)
        return text
    end
    local unit = unit_of(name)
    if ty.is_real then
        tree:add(fields[name], range, range:le_float()):append_text(unit)
        return string.format("%.4g", range:le_float()) .. unit
    end
    tree:add_le(fields[name], range):append_text(unit)
    if ty.names then return ty.names[range:uint()] end
    return tostring(ty == i24 and range:le_int() or range:le_uint()) .. unit
end

-- The info column: what one wants to see without opening the tree ------------------------------------------------------

local IN_INFO = {
    Hello = { "session" }, Arm = { "session" }, Start = { "session" },
    DescribeParameter = { "index" }, GetParameter = { "index" }, SetParameter = { "index", "value" },
    EncoderSample = { "sequence" }, TorqueAnswer = { "sequence", "torque_nm", "status" },
    Telemetry = { "sequence", "dead_zone_estimate_rad" },
    Identity = { "board", "firmware", "state" }, ParameterDescription = { "index", "name", "default", "unit" },
    ParameterReport = { "index", "outcome", "value" }, CommandResult = { "request", "outcome", "state" },
    FaultReport = { "code", "sequence", "value", "limit" }, Log = { "level", "text" },
    LineReport = { "messages", "damaged" },
}
-- Numbers that need a word before them
local WORDS = {
    sequence = "seq", index = "index", session = "session", messages = "messages", damaged = "damaged", limit = "limit",
}

local function info(name, said)
    local words = { name }
    for _, field in ipairs(IN_INFO[name] or {}) do
        if WORDS[field] then words[#words + 1] = WORDS[field] end
        if said[field] ~= "" then words[#words + 1] = said[field] end
    end
    return table.concat(words, " ")
end

-- Gives the info text, or nil with the problem
local function show_message(tree, message, body, body_len)
    local name, at, said = message[1], 1, {}
    local expected = 1
    for _, field in ipairs(message[2]) do expected = expected + field[2].len end
    if expected ~= body_len then
        return nil, string.format("%s takes %d bytes, got %d", name, expected, body_len)
    end
    for _, field in ipairs(message[2]) do
        local range = body(at, field[2].len)
        said[field[1]] = show_field(tree, field, range)
        if not said[field[1]] then
            return nil, string.format("%s.%s holds bytes that are no value of its type", name, field[1])
        end
        at = at + field[2].len
    end
    if name == "CommandResult" then
        said.request = KIND_NAMES[body(1, 1):uint()] or "unknown request"
        tree:append_text(", to " .. said.request)
    elseif name == "FaultReport" then
        tree:add_proto_expert_info(experts.fault, "The drive latched " .. said.code)
    end
    return info(name, said)
end

function lashloop.dissector(buffer, pinfo, root)
    pinfo.cols.protocol = "Lashloop"
    local wire = buffer:raw()
    local tree = root:add(lashloop, buffer())
    tree:add(fields.stuffed, buffer())

    local function bad(expert_info, reason)
        tree:add_proto_expert_info(expert_info, reason)
        pinfo.cols.info = "BAD: " .. reason
        return #wire
    end

    if wire == "\0" then
        pinfo.cols.info = "delimiter alone: clears the line"
        return 1
    end
    if wire:byte(-1) ~= 0 then
        return bad(experts.malformed, string.format("%d bytes without a delimiter", #wire))
    end
    if #wire > LONGEST_FRAME then
        return bad(experts.malformed, string.format("%d bytes, a frame has at most %d", #wire, LONGEST_FRAME))
    end
    local unstuffed = unstuff(wire:sub(1, -2))
    if not unstuffed then
        return bad(experts.malformed, "not stuffed as COBS asks")
    end
    local body_len = #unstuffed - CRC_LENGTH
    if body_len < 1 then
        return bad(experts.malformed, "too short for a kind and a CRC")
    end

    local frame = ByteArray.new(unstuffed, true):tvb("frame without stuffing")
    local found, computed = frame(body_len, CRC_LENGTH):le_uint(), crc32c(unstuffed:sub(1, body_len))
    local kind = frame(0, 1):uint()
    local from_drive = kind >= 0x80
    local crc_good = found == computed

    tree:add(fields.kind, frame(0, 1))
    local crc_tree = tree:add_le(fields.crc, frame(body_len, CRC_LENGTH))
    local status = tree:add(fields.crc_status, frame(body_len, CRC_LENGTH), crc_good and 1 or 0)
    status:set_generated()
    if not crc_good then
        crc_tree:append_text(string.format(" (bad, should be 0x%08x)", computed))
        return bad(experts.crc, string.format("CRC 0x%08x in the frame, 0x%08x over its body", found, computed))
    end
    crc_tree:append_text(" (good)")
    pinfo.cols.src = from_drive and "drive" or "host"
    pinfo.cols.dst = from_drive and "host" or "drive"

    local message = MESSAGES[kind]
    if not message then
        return bad(experts.unknown, string.format("kind 0x%02x is not a message of protocol version 1", kind))
    end
    tree:append_text(", " .. message[1])
    local text, problem = show_message(tree, message, frame, body_len)
    if not text then
        return bad(experts.unknown, problem)
    end
    pinfo.cols.info = text
    return #wire
end

DissectorTable.get("wtap_encap"):add(wtap.USER0, lashloop)
