//! Names of parameters, as `PARAM_REQUEST_READ` and `PARAM_VALUE` carry them.

use crate::bytes;

/// Bytes of a parameter's name.
pub const PARAM_ID_LEN: usize = 16;

/// A parameter's name as its field has it: zeros behind it, cut at 16 bytes.
pub fn param_id(name: &str) -> [u8; PARAM_ID_LEN] {
    let mut id = [0; PARAM_ID_LEN];
    bytes::copy(name.as_bytes(), &mut id);
    id
}

/// The name in a field, up to its first zero; nothing if it is no text.
pub fn param_name(id: &[u8; PARAM_ID_LEN]) -> &str {
    let end = id.iter().position(|&byte| byte == 0).unwrap_or(PARAM_ID_LEN);
    core::str::from_utf8(&id[..end]).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_of_up_to_sixteen_bytes_comes_back() {
        for name in ["", "SYS_HITL", "SIXTEEN_LETTERS_"] {
            assert_eq!(param_name(&param_id(name)), name);
        }
        assert_eq!(param_name(&param_id("SEVENTEEN_LETTERS")), "SEVENTEEN_LETTER");
        assert_eq!(param_name(&[0xff; PARAM_ID_LEN]), "");
    }
}
