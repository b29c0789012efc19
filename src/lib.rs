//! A rate table in software.
