use super::status::Status;
use super::*;
use crate::time::SimTime;
pub(super) const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
pub(super) struct Channels;
pub(super) struct Subscriber;
impl Channels {
    pub fn new(_: &About) -> Self {
        Channels
    }
    pub fn server_info(&self, _: &str) -> String {
        String::new()
    }
    pub fn advertise(&self) -> String {
        String::new()
    }
    pub fn unadvertise(&self) -> String {
        String::new()
    }
    pub fn messages(&self, _: &Batch, _: &dyn Fn(u32) -> bool, _: &mut dyn FnMut(u32, SimTime, &[u8])) {}
    pub fn diagnostics(
        &self,
        _: SimTime,
        _: &[Status],
        _: &dyn Fn(u32) -> bool,
        _: &mut dyn FnMut(u32, SimTime, &[u8]),
    ) {
    }
}
impl Subscriber {
    pub fn new() -> Self {
        Subscriber
    }
    pub fn hear(&mut self, _: &Channels, _: &str) -> Vec<String> {
        vec![]
    }
    pub fn hear_binary(&mut self, _: &[u8]) -> Vec<String> {
        vec![]
    }
    pub fn wants(&self, _: u32) -> bool {
        false
    }
    pub fn frames(&self, _: u32, _: SimTime, _: &[u8], _: &mut dyn FnMut(Vec<u8>)) {}
}
