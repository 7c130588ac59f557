//! Encoding of values as messages, in the `postcard` format.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::radio::Message;
use crate::{Error, Result};

/// Encodes a value.
pub(crate) fn encoded<T: Serialize>(value: &T) -> Result<Vec<u8>> {
    postcard::to_stdvec(value).map_err(not_encodable)
}

/// Encodes a value as bytes other than 0 (consistent overhead byte stuffing, COBS).
pub(crate) fn encoded_without_zero<T: Serialize>(value: &T) -> Result<Vec<u8>> {
    let mut bytes = postcard::to_stdvec_cobs(value).map_err(not_encodable)?;
    // The last byte is the 0 that terminates a COBS frame.
    bytes.pop();
    Ok(bytes)
}

/// Decodes a value from [`encoded`] bytes.
pub(crate) fn decoded<T: DeserializeOwned>(message: &Message) -> Result<T> {
    decode_all(&message.bytes).ok_or_else(|| garbled(message))
}

/// Decodes a value from [`encoded_without_zero`] bytes.
pub(crate) fn decoded_without_zero<T: DeserializeOwned>(message: &Message) -> Result<T> {
    let mut bytes = message.bytes.clone();
    bytes.push(0);
    let len = cobs::decode_in_place(&mut bytes).ok();
    len.and_then(|len| decode_all(&bytes[..len])).ok_or_else(|| garbled(message))
}

/// Decodes a value from all bytes; `None` if bytes are left over or the value is invalid.
fn decode_all<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    postcard::take_from_bytes(bytes).ok().filter(|(_, rest)| rest.is_empty()).map(|(value, _)| value)
}

fn not_encodable(error: postcard::Error) -> Error {
    Error::OutOfRange { what: "value of a message", value: error.to_string(), accepted: "what `postcard` encodes" }
}

fn garbled(message: &Message) -> Error {
    Error::Garbled { from: message.from, bytes: message.bytes.clone(), expected: "a value of the expected type" }
}
