//! (contact)
