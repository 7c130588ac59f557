//! Tests of channel and station.
