//! A firmware's receiving side on the host.
