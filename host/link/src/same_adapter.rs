//! Whether a port that was opened again has the adapter that it had before.

use super::LinkError;
use super::usb_adapter::UsbAdapter;

/// Checks that a terminal has the adapter that it had when it was opened `first`, and returns that one.
///
/// # Errors
/// [`LinkError::OtherAdapter`] for another one, [`LinkError::Disconnected`] for none.
pub fn same_adapter(
    first: Option<&UsbAdapter>,
    found: Option<UsbAdapter>,
) -> Result<Option<UsbAdapter>, LinkError> {
    match (first, found) {
        (None, found) => Ok(found),
        (Some(_), None) => Err(LinkError::Disconnected),
        (Some(expected), Some(found)) if *expected != found => {
            Err(LinkError::OtherAdapter { expected: Box::new(expected.clone()), found: Box::new(found) })
        }
        (Some(_), found) => Ok(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::usb_adapter::Unit;

    fn serial(number: &str) -> Unit {
        Unit::SerialNumber(number.to_owned())
    }

    fn place(place: &str) -> Unit {
        Unit::Place(place.to_owned())
    }

    fn adapter(unit: Unit) -> UsbAdapter {
        UsbAdapter { vendor: 0x0403, product: 0x6001, unit }
    }

    #[test]
    fn an_adapter_is_the_same_in_another_socket_by_its_serial_number() {
        let first = adapter(serial("A50285BI"));
        let moved = adapter(serial("A50285BI"));
        assert!(matches!(same_adapter(Some(&first), Some(moved)), Ok(Some(_))));
    }

    #[test]
    fn another_adapter_under_the_old_name_is_rejected() {
        let (first, other) = (adapter(serial("A50285BI")), adapter(serial("B1")));
        let error = same_adapter(Some(&first), Some(other)).expect_err("another serial number");
        assert!(matches!(error, LinkError::OtherAdapter { .. }), "{error:?}");
        let text = error.to_string();
        assert!(
            text.contains("A50285BI") && text.contains("B1") && text.contains("/dev/serial/by-id"),
            "{text}"
        );
    }

    #[test]
    fn adapters_without_serial_numbers_differ_by_their_place() {
        let (first, same, other) = (adapter(place("1-2")), adapter(place("1-2")), adapter(place("1-3")));
        assert!(same_adapter(Some(&first), Some(same)).is_ok());
        assert!(same_adapter(Some(&first), Some(other)).is_err());
    }

    #[test]
    fn an_unplugged_adapter_is_disconnected_and_a_first_one_is_taken() {
        let first = adapter(serial("A"));
        assert!(matches!(same_adapter(Some(&first), None), Err(LinkError::Disconnected)));
        assert!(matches!(same_adapter(None, None), Ok(None)));
        assert_eq!(same_adapter(None, Some(first.clone())).unwrap(), Some(first));
    }
}
