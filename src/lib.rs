//! Tyndall.
