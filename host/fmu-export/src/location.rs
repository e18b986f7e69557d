//! Where an importer says that the resources are: a `file:` URI in FMI 2.0, a path in FMI 3.0.

use std::path::PathBuf;

/// The folder of a `file:` URI, or of a plain path.
#[must_use]
pub fn folder(location: &str) -> PathBuf {
    let Some(rest) = location.strip_prefix("file:") else { return location.into() };
    // An empty host, or that of this machine.
    let path = rest.strip_prefix("//").map_or(rest, |rest| rest.strip_prefix("localhost").unwrap_or(rest));
    let mut bytes = Vec::new();
    let mut rest = path.as_bytes();
    while let [first, tail @ ..] = rest {
        let decoded = match rest {
            [b'%', high, low, ..] => std::str::from_utf8(&[*high, *low])
                .ok()
                .and_then(|digits| u8::from_str_radix(digits, 16).ok()),
            _ => None,
        };
        bytes.push(decoded.unwrap_or(*first));
        rest = if decoded.is_some() { &rest[3..] } else { tail };
    }
    String::from_utf8_lossy(&bytes).into_owned().into()
}

#[cfg(test)]
mod tests {
    use super::folder;

    #[test]
    fn a_uri_of_every_importer_is_its_folder() {
        for location in ["file:///tmp/a%20b/resources", "file:/tmp/a%20b/resources", "/tmp/a b/resources"] {
            assert_eq!(folder(location).to_str(), Some("/tmp/a b/resources"), "{location}");
        }
        assert_eq!(folder("file://localhost/tmp/100%25/%c3%a4").to_str(), Some("/tmp/100%/\u{e4}"));
        assert_eq!(folder("file:///tmp/100%").to_str(), Some("/tmp/100%"));
        // A path isn't encoded.
        assert_eq!(folder("/tmp/a%20b").to_str(), Some("/tmp/a%20b"));
    }
}
