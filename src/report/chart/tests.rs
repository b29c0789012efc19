//! Every chart is read back as XML.
