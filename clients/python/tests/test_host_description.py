"""Descriptions of a drive as a host reads them, and its subscription."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import pytest

from lashloop.control import ControlLaw, choice, f32, signal
from lashloop.control.cascade import PD
from lashloop.drive import Drive
from lashloop.enums import Outcome, ParameterFlags, State
from lashloop.host import CountError, DescriptionError, Host, ParameterRangeError, RejectedError, UnknownSignalError
from lashloop.messages import (
    Arm,
    CommandResult,
    DescribeLaw,
    DriveMessage,
    Identity,
    LawDescription,
    ParameterDescription,
    Subscribe,
    Telemetry,
)
from simulated_link import SimulatedLink, opened, step

if TYPE_CHECKING:
    from collections.abc import Callable

    from simulated_link import Altered

OTHER = ControlLaw(
    name="other",
    parameters=(choice("mode", ["slow", "fast"], "fast"), f32("gain", "", 1.0, 0.0, 2.0, live=True)),
    signals=(signal("other_rad", "rad"),),
    build=PD.build,
)


def two_laws() -> SimulatedLink:
    """A link to a drive with the laws `pd` and `other`."""
    link = SimulatedLink()
    link.dut.drive = Drive([PD, OTHER], clock_ns=link.dut.clock)
    return link


def test_a_host_lists_laws_parameters_and_signals_by_name() -> None:
    host = opened(two_laws())
    assert host.laws == ("pd", "other")
    mode, gain = host.parameters["mode"], host.parameters["gain"]
    assert (mode.laws, mode.choices, mode.live, mode.allowed) == (("other",), ("slow", "fast"), False, "slow | fast")
    assert (gain.laws, gain.choices, gain.live, gain.allowed) == (("other",), (), True, "0 to 2")
    assert host.parameters["controller"].choices == host.laws
    assert host.parameters["torque_limit_nm"].laws == host.laws
    assert host.signals["requested_torque_nm"].laws == host.laws
    assert (host.signals["other_rad"].laws, host.signals["other_rad"].unit) == (("other",), "rad")


def test_descriptions_are_requested_once() -> None:
    link = two_laws()
    host = opened(link)
    assert host.laws
    before = len(link.sent)
    assert host.parameters
    assert host.signals
    assert len(link.sent) == before
    assert link.count(DescribeLaw) == 2


def test_a_choice_is_set_by_its_name_or_its_number() -> None:
    host = opened(two_laws())
    mode = host.parameter("mode")
    assert mode.text(host.get("mode")) == "fast"
    assert host.set("mode", "slow") == host.get("mode") == 0
    assert host.set("mode", 1) == 1
    for wrong in ("Slow", "", 2, 0.5):
        with pytest.raises(ParameterRangeError, match=r"the drive accepts slow \| fast"):
            host.set("mode", wrong)


def test_the_default_subscription_has_the_signals_of_the_law_in_force() -> None:
    host = opened(two_laws())
    assert host.subscribe() == ("requested_torque_nm", *(it.name for it in PD.signals))
    host.set("controller", "other")
    assert host.subscribe() == ("requested_torque_nm", "other_rad")


def test_the_default_subscription_is_limited_to_13_signals() -> None:
    link = SimulatedLink()
    many = replace(PD, signals=tuple(signal(f"s{number}", "") for number in range(20)))
    link.dut.drive = Drive([many], clock_ns=link.dut.clock)
    host = opened(link)
    assert len(host.subscribe()) == 13
    with pytest.raises(RejectedError, match="rejected Subscribe in state Idle: OutOfRange"):
        host.subscribe(f"s{number}" for number in range(14))


def test_a_signal_that_the_drive_lacks_is_named_and_not_sent() -> None:
    link = two_laws()
    host = opened(link)
    with pytest.raises(UnknownSignalError, match="no signal load_eror_rad; did you mean load_error_rad"):
        host.subscribe(["load_eror_rad"])
    assert link.count(Subscribe) == 0


def test_a_signal_of_another_law_is_reported_at_arming_by_name() -> None:
    host = opened(two_laws())
    host.subscribe(["other_rad"])
    expected = r"rejected Arm in state Idle: SignalOfOtherLaw \(other_rad isn't a signal of the law in force\)"
    with pytest.raises(RejectedError, match=expected) as raised:
        host.arm()
    assert raised.value.cause == "other_rad isn't a signal of the law in force"
    host.set("controller", "other")
    host.arm()


def test_telemetry_of_an_earlier_host_has_no_names() -> None:
    link = SimulatedLink()
    opened(link).subscribe(["load_error_rad"], every=1)
    host = started(Host(link, session=8, clock=link.clock))
    step(host)
    step(host)
    assert host.telemetry is not None
    assert (len(host.telemetry.message.values), host.telemetry.values) == (1, {})
    host.subscribe(["load_error_rad"], every=1)
    step(host)
    step(host)
    assert list(host.telemetry.values) == ["load_error_rad"]
    with pytest.raises(KeyError, match="motor_error_rad"):
        host.telemetry["motor_error_rad"]


def started(host: Host) -> Host:
    """The host in a run."""
    host.set("watchdog_us", 10_000_000)
    host.arm()
    host.start()
    return host


def test_a_reset_ends_the_subscription() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.subscribe(every=1)
    host.reset()
    started(host)
    step(host)
    step(host)
    assert host.telemetry is None


def with_telemetry(link: SimulatedLink, *values: float) -> None:
    """Make the drive send this telemetry before every message."""
    link.alters = lambda message: [Telemetry(0, values), message]


def test_telemetry_after_a_reset_has_no_names() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.subscribe(["load_error_rad"])
    host.reset()
    started(host)
    with_telemetry(link, 1.0)
    step(host)
    assert host.telemetry is not None
    assert (host.telemetry.message.values, host.telemetry.values) == ((1.0,), {})


def test_telemetry_of_another_length_than_the_subscription_has_no_names() -> None:
    link = SimulatedLink()
    host = opened(link)
    host.subscribe(["load_error_rad", "motor_error_rad"])
    started(host)
    for values in ((1.0,), (1.0, 2.0, 3.0)):
        with_telemetry(link, *values)
        step(host)
        assert host.telemetry is not None
        assert (host.telemetry.message.values, host.telemetry.values) == (values, {})
    with_telemetry(link, 1.0, 2.0)
    step(host)
    assert host.telemetry is not None
    assert host.telemetry.values == {"load_error_rad": 1.0, "motor_error_rad": 2.0}


def altered(change: Callable[[DriveMessage], DriveMessage]) -> Host:
    """A host whose link changes messages of the drive."""
    link = SimulatedLink()
    link.alters = lambda message: [change(message)]
    return opened(link)


def test_a_drive_that_lacks_an_index_of_its_identity_is_reported() -> None:
    host = altered(lambda it: replace(it, law_count=2) if isinstance(it, Identity) else it)
    with pytest.raises(RejectedError, match="rejected DescribeLaw in state Idle: UnknownIndex"):
        _ = host.laws
    host = altered(lambda it: replace(it, parameter_count=200) if isinstance(it, Identity) else it)
    with pytest.raises(RejectedError, match="rejected DescribeParameter in state Idle: UnknownIndex"):
        _ = host.parameters


@pytest.mark.parametrize(
    ("things", "field", "count", "allowed"),
    [
        ("laws", "law_count", 0, "1 to 16"),
        ("laws", "law_count", 17, "1 to 16"),
        ("signals", "signal_count", 33, "0 to 32"),
        ("parameters", "parameter_count", 241, "0 to 240"),
    ],
)
def test_numbers_that_a_drive_can_not_have_are_rejected(things: str, field: str, count: int, allowed: str) -> None:
    link, counts = SimulatedLink(), cast("dict[str, Any]", {field: count})
    link.alters = lambda it: [replace(it, **counts) if isinstance(it, Identity) else it]
    with pytest.raises(CountError, match=f"the drive has {count} {things}, a drive has {allowed}: correct the drive"):
        opened(link)


@pytest.mark.parametrize(("name", "largest"), [("torque_limit_nm", "1000"), ("watchdog_us", "60000000")])
def test_choices_of_a_parameter_that_can_not_have_them_are_an_error_of_the_drive(name: str, largest: str) -> None:
    def with_choices(message: DriveMessage) -> DriveMessage:
        if isinstance(message, ParameterDescription) and message.name == name:
            return replace(message, flags=ParameterFlags.CHOICES)
        return message

    with pytest.raises(DescriptionError, match=f"choices for {name}, whose largest value is {largest}: "):
        _ = altered(with_choices).parameters


def test_late_descriptions_of_other_indices_are_no_answer() -> None:
    def doubled(message: DriveMessage) -> Altered:
        late: list[DriveMessage] = [
            LawDescription(9, "late"),
            CommandResult(Arm.KIND, Outcome.ACCEPTED, State.ARMED),
            Telemetry(0, (1.0,)),
        ]
        return [*late, message]

    link = SimulatedLink()
    link.alters = doubled
    assert opened(link).laws == ("pd",)


def test_a_drive_with_one_law_may_lack_the_parameter_controller() -> None:
    """Section 9: `controller` is required with 2 laws or more."""

    def renamed(message: DriveMessage) -> DriveMessage:
        if isinstance(message, ParameterDescription) and message.name == "controller":
            return replace(message, name="something_else")
        return message

    assert "load_error_rad" in altered(renamed).subscribe()


def test_an_unknown_flag_of_a_parameter_is_ignored() -> None:
    def flagged(message: DriveMessage) -> DriveMessage:
        if isinstance(message, ParameterDescription):
            return replace(message, flags=message.flags | ParameterFlags(0x80))
        return message

    parameters = altered(flagged).parameters
    assert not parameters["torque_limit_nm"].live
    assert parameters["controller"].choices == ("pd",)
