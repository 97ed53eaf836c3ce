//! Fields of a payload, in either direction.

use super::Address;

/// Moves fields between values and a payload, in the order of the calls.
pub(super) trait Fields {
    /// Fills `bytes` from the payload, or appends them to it.
    fn bytes(&mut self, bytes: &mut [u8]);

    /// Bytes that no value holds, as they are written.
    fn unused(&mut self, bytes: &[u8]) {
        self.bytes(&mut bytes.to_vec());
    }

    fn u8(&mut self, value: &mut u8) {
        self.bytes(std::slice::from_mut(value));
    }

    fn u16(&mut self, value: &mut u16) {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes);
        *value = u16::from_le_bytes(bytes);
    }

    fn u32(&mut self, value: &mut u32) {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes);
        *value = u32::from_le_bytes(bytes);
    }

    fn i32(&mut self, value: &mut i32) {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes);
        *value = i32::from_le_bytes(bytes);
    }

    fn i64(&mut self, value: &mut i64) {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes);
        *value = i64::from_le_bytes(bytes);
    }

    fn f32(&mut self, value: &mut f32) {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes);
        *value = f32::from_le_bytes(bytes);
    }

    fn address(&mut self, address: &mut Address) {
        self.u8(&mut address.system);
        self.u8(&mut address.component);
    }

    /// Text in a field of `length` bytes, ended by 0 if it is shorter. Each byte that is
    /// not UTF-8 is read as `?`, so that text is written at the length of its field.
    fn text(&mut self, text: &mut String, length: usize) {
        let mut bytes: Vec<u8> = text.bytes().take(length).collect();
        bytes.resize(length, 0);
        self.bytes(&mut bytes);
        let mut until_0 = bytes.split(|&byte| byte == 0);
        *text = text_of(until_0.next().unwrap_or_default());
    }
}

/// Bytes as text: each that is not UTF-8 is read as `?`.
pub(super) fn text_of(bytes: &[u8]) -> String {
    let mut text = String::new();
    for chunk in bytes.utf8_chunks() {
        text += chunk.valid();
        text.extend(chunk.invalid().iter().map(|_| '?'));
    }
    text
}

/// A payload from its beginning; MAVLink 2 cuts zeros off its end.
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl Fields for Reader<'_> {
    fn bytes(&mut self, bytes: &mut [u8]) {
        let (have, rest) = self.0.split_at(self.0.len().min(bytes.len()));
        bytes.fill(0);
        bytes[..have.len()].copy_from_slice(have);
        self.0 = rest;
    }
}

/// A payload being written.
pub(super) struct Writer(pub(super) Vec<u8>);

impl Fields for Writer {
    fn bytes(&mut self, bytes: &mut [u8]) {
        self.0.extend_from_slice(bytes);
    }
}
