//! The program as users call it, and its sources as contributors read them. One binary, so that the library is linked
//! once: `cargo test --test all links::` runs one module.

mod allan;
mod architecture;
mod auto;
mod bus;
mod check;
mod circles;
mod clocks;
mod cluster;
mod controllers;
mod examples;
mod faults;
mod formats;
mod generate;
mod help;
mod links;
mod listen;
mod live;
mod nothing_lost;
mod pages;
mod parts;
mod recordings;
mod reference;
mod resd;
mod score;
mod score_formats;
mod study;
mod table_1;
mod tables;
mod timing;
