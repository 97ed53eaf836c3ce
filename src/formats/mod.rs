//! Files: written, and read back exactly.
