//! The report of a study: what it draws is what was measured, whatever the
//! numbers and names; and its page works in a browser.

mod browser;
mod devtools;
mod files;
mod fixture;
mod plots;
mod tables;
