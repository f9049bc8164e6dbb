//! Tyndall.

pub mod sources;
