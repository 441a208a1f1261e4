//! What a scene calls for: the proofs, what they leave of the picture, and what
//! the survey tells.

#[path = "../common/mod.rs"]
mod common;

mod budget;
mod pixels;
mod reasons;
mod survey;
