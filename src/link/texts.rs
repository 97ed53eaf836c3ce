//! Texts that vehicles send in pieces (`STATUSTEXT` with an id), put together.

use std::collections::{BTreeMap, VecDeque};

use super::message::{Address, Message, TEXT_BYTES, TextChunk};
use super::time::Time;

/// A text whose next piece does not come for so long is not waited for, nor one that began so long ago, milliseconds.
const QUIET_MS: u64 = 1000;
const AT_MOST_MS: u64 = 5000;
/// Pieces that come after that are dropped, for this long, milliseconds.
const LATE_MS: u64 = 10_000;
/// Texts that are put together at once, pieces of each, and texts whose late pieces are recognised.
const MAX_OPEN: usize = 4;
const MAX_CHUNKS: u8 = 64;
const MAX_DONE: usize = 8;
/// What stands for pieces that were lost.
const LOST: &[u8] = b"[...]";

/// A text that has not come as a whole yet.
#[derive(Debug)]
struct Open {
    from: Address,
    id: u16,
    severity: u8,
    chunks: BTreeMap<u8, Vec<u8>>,
    since: Time,
    last: Time,
}

/// A text that was handed on: its late pieces are dropped.
#[derive(Debug)]
struct Done {
    from: Address,
    id: u16,
    first: Option<Vec<u8>>,
    at: Time,
}

/// A text of a vehicle as a line: PX4 ends each with a tab.
#[must_use]
pub(crate) fn as_line(text: &str) -> String {
    text.trim_end().replace('\t', " ")
}

/// Puts the texts of one system together.
#[derive(Debug, Default)]
pub struct TextChunks {
    open: Vec<Open>,
    done: VecDeque<Done>,
    whole: VecDeque<(Address, Message)>,
}

impl TextChunks {
    /// Takes in a piece.
    pub fn take(&mut self, now: Time, from: Address, chunk: &TextChunk) {
        let bytes = chunk.text();
        if chunk.seq >= MAX_CHUNKS || self.is_late(now, (from, chunk), bytes) {
            return;
        }
        let is_it = |of: &Open| (of.from, of.id) == (from, chunk.id);
        let at = self.open.iter().position(is_it).unwrap_or_else(|| {
            if self.open.len() >= MAX_OPEN {
                self.close(now, 0);
            }
            self.open.push(Open {
                from,
                id: chunk.id,
                severity: chunk.severity,
                chunks: BTreeMap::new(),
                since: now,
                last: now,
            });
            self.open.len() - 1
        });
        let open = &mut self.open[at];
        open.last = now;
        open.severity = open.severity.min(chunk.severity);
        open.chunks
            .entry(chunk.seq)
            .or_insert_with(|| bytes.to_vec());
        if open.is_whole() {
            self.close(now, at);
        }
    }

    /// Whether a piece is of a text that was handed on; a new text may have its id.
    fn is_late(&self, now: Time, (from, chunk): (Address, &TextChunk), bytes: &[u8]) -> bool {
        let is_it = |of: &&Done| (of.from, of.id) == (from, chunk.id) && now - of.at < LATE_MS;
        let is_open = self
            .open
            .iter()
            .any(|of| (of.from, of.id) == (from, chunk.id));
        let begins = |done: &Done| chunk.seq == 0 && done.first.as_deref() != Some(bytes);
        let done = self.done.iter().rev().find(is_it);
        !is_open && done.is_some_and(|done| done.first.is_none() || !begins(done))
    }

    /// The next text that is whole, or is not waited for any more, as a message of its sender.
    pub fn poll(&mut self, now: Time) -> Option<(Address, Message)> {
        let is_over = |of: &Open| now - of.last >= QUIET_MS || now - of.since >= AT_MOST_MS;
        while let Some(at) = self.open.iter().position(is_over) {
            self.close(now, at);
        }
        self.whole.pop_front()
    }

    fn close(&mut self, now: Time, at: usize) {
        let open = self.open.remove(at);
        if self.done.len() >= MAX_DONE {
            self.done.pop_front();
        }
        self.whole
            .push_back((open.from, Message::of_text(open.severity, &open.bytes())));
        self.done.push_back(Done {
            from: open.from,
            id: open.id,
            first: open.chunks.get(&0).cloned(),
            at: now,
        });
    }
}

impl Open {
    /// Whether all of it has come: a piece that is not full is the last one.
    fn is_whole(&self) -> bool {
        let last = self.chunks.last_key_value();
        let ends =
            last.is_some_and(|(seq, bytes)| bytes.len() < TEXT_BYTES || *seq + 1 == MAX_CHUNKS);
        ends && self
            .chunks
            .keys()
            .copied()
            .eq(0..=last.map_or(0, |(seq, _)| *seq))
    }

    /// What has come of it, with marks for what has not.
    fn bytes(&self) -> Vec<u8> {
        let mut text = Vec::new();
        let mut next = 0;
        for (seq, bytes) in &self.chunks {
            if *seq > next {
                text.extend(LOST);
            }
            text.extend(bytes);
            next = seq.saturating_add(1);
        }
        let last = self.chunks.values().next_back();
        if last.is_some_and(|bytes| bytes.len() == TEXT_BYTES) {
            text.extend(LOST);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FROM: Address = Address {
        system: 1,
        component: 1,
    };

    fn chunk(id: u16, seq: u8, text: &str) -> TextChunk {
        let mut bytes = [0; TEXT_BYTES];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        TextChunk {
            severity: 2,
            bytes,
            id,
            seq,
        }
    }

    fn texts(chunks: &mut TextChunks, now: Time) -> Vec<String> {
        let polled = std::iter::from_fn(|| chunks.poll(now));
        let text = |message| match message {
            Message::StatusText { text, .. } => text,
            other => panic!("{other:?}"),
        };
        polled.map(|(_, message)| text(message)).collect()
    }

    #[test]
    fn pieces_in_any_order_and_twice_are_one_text_and_letters_across_them_are_whole() {
        let mut chunks = TextChunks::default();
        let mut first = chunk(7, 0, &"b".repeat(TEXT_BYTES));
        let mut after = chunk(7, 1, &"a".repeat(TEXT_BYTES));
        let last = chunk(7, 2, " end");
        // An ö on two pieces.
        (first.bytes[TEXT_BYTES - 1], after.bytes[0]) = (0xc3, 0xb6);
        for piece in [&last, &after, &last, &first] {
            assert_eq!(texts(&mut chunks, Time(10)), [""; 0]);
            chunks.take(Time(10), FROM, piece);
        }
        let side = TEXT_BYTES - 1;
        let expected = format!("{}ö{} end", "b".repeat(side), "a".repeat(side));
        assert_eq!(texts(&mut chunks, Time(10)), [expected]);
        // Late, again: dropped; another text with its id is not.
        chunks.take(Time(500), FROM, &after);
        chunks.take(Time(500), FROM, &first);
        assert_eq!(texts(&mut chunks, Time(5000)), [""; 0]);
        chunks.take(Time(5100), FROM, &chunk(7, 0, "another"));
        assert_eq!(texts(&mut chunks, Time(5100)), ["another"]);
    }

    #[test]
    fn a_text_that_lost_pieces_is_handed_on_after_a_time_with_marks() {
        let mut chunks = TextChunks::default();
        let full = "c".repeat(TEXT_BYTES);
        chunks.take(Time(0), FROM, &chunk(1, 0, &full));
        chunks.take(Time(0), FROM, &chunk(1, 2, "end"));
        chunks.take(Time(0), FROM, &chunk(2, 1, &full));
        assert_eq!(texts(&mut chunks, Time(QUIET_MS - 1)), [""; 0]);
        let expected = [format!("{full}[...]end"), format!("[...]{full}[...]")];
        assert_eq!(texts(&mut chunks, Time(QUIET_MS)), expected);
        // What was lost comes late.
        chunks.take(Time(QUIET_MS + 10), FROM, &chunk(1, 1, &full));
        chunks.take(Time(QUIET_MS + 10), FROM, &chunk(2, 2, "late"));
        assert_eq!(texts(&mut chunks, Time(9000)), [""; 0]);
    }

    #[test]
    fn a_flood_of_pieces_is_bounded() {
        let mut chunks = TextChunks::default();
        let full = "d".repeat(TEXT_BYTES);
        let mut count = 0;
        for id in 1..2000 {
            for seq in [0, 1, 200] {
                chunks.take(Time(u64::from(id)), FROM, &chunk(id, seq, &full));
            }
            count += texts(&mut chunks, Time(u64::from(id))).len();
            assert!(chunks.open.len() <= MAX_OPEN && chunks.done.len() <= MAX_DONE);
        }
        assert!(count > 1900, "{count}");
        // One text without an end.
        let mut chunks = TextChunks::default();
        for seq in 0..=u8::MAX {
            chunks.take(Time(0), FROM, &chunk(1, seq, &full));
        }
        let all = texts(&mut chunks, Time(0));
        let length = usize::from(MAX_CHUNKS) * TEXT_BYTES + LOST.len();
        assert_eq!(all.iter().map(String::len).collect::<Vec<_>>(), [length]);
    }
}
