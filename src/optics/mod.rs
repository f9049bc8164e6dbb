//! Formulas, pure: no entity, no GPU.

pub mod materials;
pub mod transfer;
