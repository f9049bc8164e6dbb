//! Formulas, pure: no entity, no GPU.

pub mod transfer;
