//! Schema of the sections of a noise profile.

use schemars::JsonSchema;

/// Defines types that serve only to generate the schema; profiles are printed as tables of the keys that they set.
macro_rules! sections {
    ($($(#[$about:meta])* $name:ident { $($(#[$meta:meta])* $key:ident: [$min:literal, $max:literal],)+ })+) => {
        $(
            $(#[$about])*
            #[derive(JsonSchema)]
            #[serde(deny_unknown_fields)]
            #[expect(dead_code, reason = "only its schema is used")]
            pub(crate) struct $name {
                $($(#[$meta])* #[schemars(range(min = $min, max = $max))] $key: Option<f64>,)+
            }
        )+
    };
}

/// Defines a section with the keys common to all distance sensors, followed by its own.
macro_rules! range_section {
    ($(#[$about:meta])* $name:ident { $($(#[$meta:meta])* $key:ident: [$min:literal, $max:literal],)* }) => {
        sections! {
            $(#[$about])* $name {
                /// Standard deviation of each reading in mm.
                sigma_mm: [0, 1_000_000],
                /// Standard deviation of each reading in percent of the distance.
                sigma_percent: [0, 1000],
                /// Error of all readings in mm.
                bias_mm: [-1_000_000, 1_000_000],
                /// Standard deviation in mm, between sensors, of an error of all readings of a sensor.
                bias_sigma_mm: [0, 1_000_000],
                /// Step of the readings in mm.
                step_mm: [0, 1_000_000],
                /// Probability of a reading anywhere in the sensor's range.
                outlier: [0, 1],
                /// Probability of a reading of nothing.
                dropout: [0, 1],
                /// Error in mm at the start of the run, which dies away.
                drift_mm: [-1_000_000, 1_000_000],
                /// Time in s in which it dies away to 1/e; 60 if left out.
                drift_s: [0.001, 1e9],
                $($(#[$meta])* $key: [$min, $max],)*
            }
        }
    };
}

range_section! {
    /// Errors of sensors of distance.
    RangeNoiseForm {}
}

range_section! {
    /// Errors of sensors of distance whose type has noise of its own.
    EchoNoiseForm {
        /// Share of that noise, of which the sensor's own `sigma` and `mean` say how much it is; 1 for all of it.
        device: [0, 1000],
    }
}

sections! {
    /// Errors of a compass.
    CompassNoiseForm {
        /// Standard deviation of each reading in degrees.
        sigma_deg: [0, 360],
        /// Error of all readings in degrees.
        bias_deg: [-360, 360],
        /// Standard deviation in degrees, between compasses, of an error of all readings of a compass.
        bias_sigma_deg: [0, 360],
        /// Step of the readings in degrees.
        step_deg: [0, 360],
    }

    /// Errors of the images of a camera.
    CameraNoiseForm {
        /// Standard deviation of the lens's point spread, in pixels.
        blur: [0, 20],
        /// Standard deviation of each channel of each pixel, of 255 levels.
        sigma: [0, 255],
        /// Probability of a white or black pixel.
        salt_and_pepper: [0, 1],
        /// Share of white among those; 0.5 if left out.
        salt: [0, 1],
        /// Probability of a pixel of random colour.
        hundreds_and_thousands: [0, 1],
    }

    /// What lies between commands and motion.
    DriveNoiseForm {
        /// By how many percent the left wheels are larger than their nominal diameter.
        left_percent: [-50, 100],
        /// By how many percent the right wheels are larger than their nominal diameter.
        right_percent: [-50, 100],
        /// Standard deviation of that in percent, drawn once for each wheel.
        diameter_sigma_percent: [0, 5],
        /// Slip in percent of a wheel's way.
        slip_percent: [-100, 100],
        /// Standard deviation of the slip in percent, drawn for each wheel every 10 ms.
        slip_sigma_percent: [0, 100],
        /// Standard deviation of the speed in mm/s, drawn every 10 ms.
        v_sigma_mm_s: [0, 100_000],
        /// Standard deviation of the speed in percent of it, drawn every 10 ms.
        v_sigma_percent: [0, 1000],
        /// Standard deviation of the turning speed in degrees/s, drawn every 10 ms.
        omega_sigma_deg_s: [0, 50_000],
        /// Standard deviation of the turning speed in percent of it, drawn every 10 ms.
        omega_sigma_percent: [0, 1000],
    }

    /// What lies between motion and odometry.
    OdometryNoiseForm {
        /// Standard deviation of the speed in mm/s, drawn every 10 ms.
        v_sigma_mm_s: [0, 100_000],
        /// Standard deviation of the speed in percent of it, drawn every 10 ms.
        v_sigma_percent: [0, 1000],
        /// Standard deviation of the turning speed in degrees/s, drawn every 10 ms.
        omega_sigma_deg_s: [0, 50_000],
        /// Standard deviation of the turning speed in percent of it, drawn every 10 ms.
        omega_sigma_percent: [0, 1000],
        /// Step of positions in mm.
        step_mm: [0, 1_000_000],
        /// Step of headings in degrees.
        step_deg: [0, 360],
    }

    /// What happens to messages that a radio receives.
    RadioNoiseForm {
        /// Probability of a bit of the payload that arrives inverted.
        bit_error_rate: [0, 1],
        /// Probability of a message that does not arrive.
        packet_loss: [0, 1],
    }
}
