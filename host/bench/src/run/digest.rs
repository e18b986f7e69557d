//! Digest of all torques that the drive commanded: runs with the same digest are the same bit for bit, on any link and host.

use lashloop_protocol::hex::Hex;
use sha2::{Digest, Sha256};

/// SHA-256 over the torques in the order of the steps, each an f32 in N m in four bytes, little endian.
#[derive(Debug, Clone, Default)]
pub struct TorqueDigest(Sha256);

impl TorqueDigest {
    /// Appends the torque of the next step, in N m.
    pub fn push(&mut self, torque_nm: f32) {
        self.0.update(torque_nm.to_le_bytes());
    }

    /// The digest in lower-case hexadecimal, 64 digits.
    #[must_use]
    pub fn finish(self) -> String {
        hexadecimal(self.0)
    }
}

/// SHA-256 of `bytes` in lower-case hexadecimal, 64 digits.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

/// The digest of what was hashed, in lower-case hexadecimal, 64 digits.
#[must_use]
pub fn hexadecimal(hash: Sha256) -> String {
    Hex(&hash.finalize()).to_string()
}

#[cfg(test)]
mod tests {
    use super::TorqueDigest;

    fn digest(torques_nm: &[f32]) -> String {
        let mut digest = TorqueDigest::default();
        torques_nm.iter().for_each(|&torque_nm| digest.push(torque_nm));
        digest.finish()
    }

    #[test]
    fn a_digest_is_sha_256_of_the_little_endian_bytes() {
        // printf '' | sha256sum; printf '\0\0\200\077\0\0\040\300' | sha256sum (1.0 and -2.5)
        assert_eq!(digest(&[]), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
        assert_eq!(digest(&[1.0, -2.5]), "48943f7a0ea247f8e3c9386d0c5822fe181d323a9289980426638cc4e72a43e1");
    }

    #[test]
    fn order_and_sign_of_zero_change_the_digest() {
        assert_ne!(digest(&[1.0, 2.0]), digest(&[2.0, 1.0]));
        assert_ne!(digest(&[0.0]), digest(&[-0.0]));
    }
}
