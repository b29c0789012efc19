//! Each filter on readings without error.
