//! One input as several files.

/// The first file, which has no name, and those that a line `=== NAME` starts.
pub fn split(data: &[u8]) -> (Vec<u8>, Vec<(String, Vec<u8>)>) {
    let mut main = Vec::new();
    let mut others: Vec<(String, Vec<u8>)> = Vec::new();
    for line in data.split_inclusive(|&byte| byte == b'\n') {
        match line.strip_prefix(b"=== ") {
            Some(name) => others.push((String::from_utf8_lossy(name.trim_ascii()).into_owned(), Vec::new())),
            None => others.last_mut().map_or(&mut main, |(_, text)| text).extend_from_slice(line),
        }
    }
    (main, others)
}
