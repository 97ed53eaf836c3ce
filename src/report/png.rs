//! A small shading picture inside a page, as PNG in a data URI.
//!
//! Stored, not compressed: compressors choose by processor, and the report has
//! the same bytes everywhere. A byte a pixel is small enough.

/// A shade: 128 is clear, lower darkens, higher lightens, up to opaque.
pub(super) type Shade = u8;

/// A `data:` URI of a picture, its rows from the top (PNG, third edition).
pub(super) fn data_uri(columns: u32, shades: &[Shade]) -> String {
    let width = usize::try_from(columns).map_or(1, |columns| columns.max(1));
    let rows = u32::try_from(shades.len() / width).unwrap_or(u32::MAX);
    let mut header = Vec::with_capacity(13);
    header.extend(columns.to_be_bytes());
    header.extend(rows.to_be_bytes());
    // 8 bits, palette, deflate, adaptive filters, not interlaced.
    header.extend([8, 3, 0, 0, 0]);
    let colours: Vec<u8> = (0..=u8::MAX)
        .flat_map(|shade| if shade < 128 { [28, 38, 48] } else { [255; 3] })
        .collect();
    let opacities: Vec<u8> = (0..=u8::MAX)
        .map(|shade| shade.abs_diff(128).saturating_mul(2))
        .collect();
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    chunk(&mut file, *b"IHDR", &header);
    chunk(&mut file, *b"PLTE", &colours);
    chunk(&mut file, *b"tRNS", &opacities);
    chunk(&mut file, *b"IDAT", &stored(width, shades));
    chunk(&mut file, *b"IEND", &[]);
    format!("data:image/png;base64,{}", base64(&file))
}

/// Unfiltered rows as a zlib stream of stored blocks (RFC 1950, RFC 1951 3.2.4).
fn stored(width: usize, shades: &[Shade]) -> Vec<u8> {
    let rows: Vec<u8> = shades
        .chunks_exact(width)
        .flat_map(|row| std::iter::once(0).chain(row.iter().copied()))
        .collect();
    let mut stream = vec![0x78, 0x01];
    let mut blocks = rows.chunks(usize::from(u16::MAX)).peekable();
    while let Some(block) = blocks.next() {
        let length = u16::try_from(block.len()).unwrap_or(u16::MAX);
        stream.push(u8::from(blocks.peek().is_none()));
        stream.extend(length.to_le_bytes());
        stream.extend((!length).to_le_bytes());
        stream.extend(block);
    }
    stream.extend(adler32(&rows).to_be_bytes());
    stream
}

fn chunk(file: &mut Vec<u8>, kind: [u8; 4], content: &[u8]) {
    let length = u32::try_from(content.len()).unwrap_or(u32::MAX);
    let start = file.len() + 4;
    file.extend(length.to_be_bytes());
    file.extend(kind);
    file.extend(content);
    let sum = crc32(&file[start..]);
    file.extend(sum.to_be_bytes());
}

/// ISO 3309, as in PNG annex D.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| {
            if sum & 1 == 1 {
                sum >> 1 ^ 0xEDB8_8320
            } else {
                sum >> 1
            }
        })
    })
}

/// RFC 1950, section 9.
fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    b << 16 | a
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits = group
            .iter()
            .chain(&[0, 0])
            .take(3)
            .fold(0_usize, |bits, byte| bits << 8 | usize::from(*byte));
        for place in 0..4 {
            let digit = ALPHABET[bits >> (18 - 6 * place) & 63];
            text.push(if place <= group.len() {
                char::from(digit)
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{adler32, base64, crc32};

    /// The vectors of RFC 4648, section 10.
    #[test]
    fn base64_agrees_with_the_vectors_of_its_rfc() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    /// The check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC
    /// algorithms, and the Adler-32 of "Wikipedia" from the article on it.
    #[test]
    fn checksums_agree_with_published_values() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        assert_eq!(adler32(b"Wikipedia"), 0x11E6_0398);
    }
}
