//! Errors of a radio.

/// What the channel does to what a robot receives: what a noise profile says of it. The default: nothing.
///
/// Source: Koestler & Bräunl, section 5.1: the binary symmetric channel with a bit error rate, and whole packets that are lost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Radio {
    /// Probability P_b that a bit of the payload arrives inverted, in [0, 1].
    pub bit_error_rate: f64,
    /// Probability P_p that a message does not arrive, in [0, 1].
    pub packet_loss: f64,
}
