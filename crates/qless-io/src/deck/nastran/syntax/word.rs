//! The first word of a line.

/// The first word in capitals, and what follows it.
pub fn keyword(text: &[u8]) -> (String, &[u8]) {
    let text = text.trim_ascii();
    let end = text.iter().position(|byte| !byte.is_ascii_alphanumeric()).unwrap_or(text.len());
    (String::from_utf8_lossy(&text[..end]).to_ascii_uppercase(), &text[end..])
}
