//! stub
pub struct Status;
pub(super) fn of(_: &super::story::Story) -> Vec<Status> {
    vec![]
}
