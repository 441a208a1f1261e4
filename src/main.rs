//! nephroid.
fn main() {}
