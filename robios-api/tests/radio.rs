//! The radio on the fake robot, in both generations.

use robios_api::fake::Fake;
use robios_api::prelude::*;
use robios_api::{Baud, RadioSettings, RobotNumber, robios7};

#[test]
fn messages_arrive_in_order_at_their_times() {
    let fake = Fake::new()
        .message(50.millis(), RobotNumber(9), *b"before the radio is on")
        .message(300.millis(), RobotNumber(3), *b"second")
        .message(200.millis(), RobotNumber(2), *b"first");
    let run = fake.run(|robot| -> Result {
        robot.sleep(100.millis());
        let radio = robot.radio()?;
        assert_eq!((radio.waiting(), radio.try_receive()?), (0, None));
        assert_eq!(radio.receive_within(50.millis())?, None);
        let message = radio.receive()?;
        assert_eq!((message.from, message.text()?), (RobotNumber(2), "first"));
        robot.sleep(200.millis());
        assert_eq!(radio.waiting(), 1);
        assert_eq!(radio.try_receive()?.map(|message| message.bytes), Some(b"second".to_vec()));
        let status = radio.status()?;
        assert_eq!((status.id, status.sent, status.received, status.waiting), (RobotNumber(1), 0, 2, 0));
        Ok(())
    });
    run.expect_finished();
}

#[test]
fn overlong_message_is_rejected() {
    let run = Fake::new().run(|robot| -> Result {
        let radio = robot.radio()?;
        radio.broadcast(&[7; robios_api::MAX_MESSAGE])?;
        let refused = radio.send(RobotNumber(2), &[7; robios_api::MAX_MESSAGE + 1]).map_err(|error| error.to_string());
        assert_eq!(refused, Err("`36` is not a valid length of a message in bytes, accepted: up to 35".to_owned()));
        Ok(())
    });
    let run = run.expect_finished();
    assert_eq!((run.sent().len(), run.sent()[0].to, run.sent()[0].bytes.len()), (1, RobotNumber::ALL, 35));
}

#[test]
fn settings_change_only_before_the_radio_is_on() {
    let run = Fake::new().run(|robot| -> Result {
        let settings = RadioSettings { speed: Some(Baud::B9600), id: Some(RobotNumber(77)) };
        let radio = robot.radio_with(settings)?;
        assert_eq!((radio.settings()?, radio.status()?.id), (settings, RobotNumber(77)));
        assert!(robot.radio_with(RadioSettings { speed: None, id: Some(RobotNumber(3)) }).is_err(), "the radio is on");
        let same = robot.radio()?;
        drop(radio);
        same.broadcast(b"still on")?;
        drop(same);
        Ok(())
    });
    let run = run.expect_finished();
    assert_eq!(["RADIOInit", "RADIOTerm"].map(|name| run.calls_of(name).count()), [1, 1]);
}

#[test]
fn endless_receive_is_stopped() {
    let run = Fake::new().until(5.seconds()).run(|robot| robot.radio()?.receive().map(drop));
    assert!(run.expect_time_up().calls().iter().any(|call| call.name == "RADIORecv"));
}

#[test]
fn robios7_messages_end_at_a_zero() {
    let run = Fake::new().message(200.millis(), RobotNumber(2), *b"cut\0here").run_robios7(
        |robot: &robios7::Robot| -> Result {
            let radio = robot.radio()?;
            assert_eq!((radio.id(), radio.robots()), (RobotNumber(1), vec![RobotNumber(1)]));
            assert!(radio.send(RobotNumber(2), b"no \0").is_err());
            assert!(radio.send(RobotNumber(2), &[b'x'; robios7::MAX_MESSAGE + 1]).is_err());
            radio.send(RobotNumber(2), &[b'x'; robios7::MAX_MESSAGE])?;
            assert_eq!(radio.receive()?.text()?, "cut");
            Ok(())
        },
    );
    assert_eq!(run.expect_finished().sent().len(), 1);
}

#[test]
fn invalid_utf8_is_an_error() {
    let run = Fake::new().message(200.millis(), RobotNumber(2), [b'a', 0xFF]).run(|robot| -> Result {
        let error = robot.radio()?.receive()?.text().map(str::to_owned).expect_err("not UTF-8");
        assert_eq!(error.to_string(), "the message of 2 bytes from robot 2 is not text");
        Ok(())
    });
    run.expect_finished();
}

#[cfg(feature = "serde")]
mod typed {
    use super::*;
    use robios_api::Message;
    use serde::{Deserialize, Serialize};

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    enum Report {
        Nothing,
        Pose { x_mm: i32, y_mm: i32, name: String },
        Many(Vec<u16>),
    }

    fn reports() -> [Report; 3] {
        let pose = Report::Pose { x_mm: -300, y_mm: 0, name: "scout".to_owned() };
        [Report::Nothing, pose, Report::Many(vec![0, 1, 500])]
    }

    /// Echoes every message.
    fn echo() -> Fake {
        Fake::new().answer(|sent| Some((1.millis(), Message { from: RobotNumber(2), bytes: sent.bytes.clone() })))
    }

    #[test]
    fn values_arrive_as_they_were_sent() {
        let run = echo().run(|robot| -> Result {
            let radio = robot.radio()?;
            for report in reports() {
                radio.send_as(RobotNumber(2), &report)?;
                assert_eq!(radio.receive_as::<Report>()?, (RobotNumber(2), report));
            }
            assert!(radio.send_as(RobotNumber(2), &Report::Many(vec![0; 100])).is_err(), "too long");
            Ok(())
        });
        run.expect_finished();
        let run = echo().run_robios7(|robot: &robios7::Robot| -> Result {
            let radio = robot.radio()?;
            for report in reports() {
                radio.send_as(RobotNumber(2), &report)?;
                assert_eq!(radio.receive_as::<Report>()?, (RobotNumber(2), report));
            }
            Ok(())
        });
        assert!(run.expect_finished().sent().iter().all(|sent| !sent.bytes.contains(&0)));
    }

    /// Flips each bit and each pair of bits of every message, and truncates the message to each length. The result is a
    /// value or an error.
    #[test]
    fn garbled_values_decode_to_errors_or_values() {
        fn garbled(bytes: &[u8]) -> Vec<Vec<u8>> {
            let inverted = |bits: &[usize]| {
                let mut bytes = bytes.to_vec();
                bits.iter().for_each(|bit| bytes[bit / 8] ^= 1 << (bit % 8));
                bytes
            };
            let count = 8 * bytes.len();
            let pairs = (0..count).flat_map(|first| (0..=first).map(move |second| [first, second]));
            let truncated = (0..bytes.len()).map(|len| bytes[..len].to_vec());
            pairs.map(|bits| inverted(&bits)).chain(truncated).collect()
        }
        let (mut values, mut errors) = (0, 0);
        let mut count = |result: Result<Report>| match result {
            Ok(_) => values += 1,
            Err(Error::Garbled { from, .. }) => {
                assert_eq!(from, RobotNumber(2));
                errors += 1;
            }
            Err(error) => panic!("{error}"),
        };
        let run = Fake::new().until(1000.seconds()).run(|robot| -> Result {
            let radio = robot.radio()?;
            for report in reports() {
                radio.send_as(RobotNumber(2), &report)?;
            }
            Ok(())
        });
        let sent: Vec<Vec<u8>> = run.expect_finished().sent().iter().map(|sent| sent.bytes.clone()).collect();
        let run = Fake::new().run(|robot| -> Result {
            let radio = robot.radio()?;
            for bytes in sent.iter().flat_map(|bytes| garbled(bytes)) {
                count(radio.decode(&Message { from: RobotNumber(2), bytes }));
            }
            Ok(())
        });
        run.expect_finished();
        let run = Fake::new().run_robios7(|robot: &robios7::Robot| -> Result {
            let radio = robot.radio()?;
            for bytes in sent.iter().flat_map(|bytes| garbled(bytes)) {
                count(radio.decode(&Message { from: RobotNumber(2), bytes }));
            }
            Ok(())
        });
        run.expect_finished();
        assert!(values > 100 && errors > 100, "{values} values, {errors} errors");
    }
}
