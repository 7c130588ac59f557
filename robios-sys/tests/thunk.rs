//! Calls a host through the tables as a program does, and checks arguments of its methods, results and log.

use std::cell::RefCell;
use std::ffi::c_void;
use std::ptr::{from_ref, null_mut};

use robios_sys::robios6::PositionType;
use robios_sys::{
    ByteBuffer, ByteSlice, CallContext, CallRecord, Callback, Out, OutBytes, Robios6, Robios6Call, Robios6Table,
    Status, Stop,
};

#[derive(Default)]
struct Robot {
    log: RefCell<Vec<String>>,
    panics: RefCell<Vec<&'static str>>,
    missing: RefCell<Vec<&'static str>>,
    is_quiet: bool,
}

impl CallContext for Robot {
    fn is_logging(&self) -> bool {
        !self.is_quiet
    }
    fn log_call(&self, record: &CallRecord<'_>) {
        self.log.borrow_mut().push(record.to_string());
    }
    fn unavailable(&self, name: &'static str) {
        self.missing.borrow_mut().push(name);
    }
    fn panicked(&self, name: &'static str, _: Box<dyn std::any::Any + Send>) {
        self.panics.borrow_mut().push(name);
    }
}

impl Robios6 for Robot {
    fn VWDriveStraight(&self, handle: i32, delta_m: f32, v_mps: f32) -> Result<i32, Stop> {
        Ok(if handle == 1 && delta_m > 0.0 && v_mps > 0.0 { 0 } else { -1 })
    }
    fn VWGetPosition(&self, _: i32, pos: &mut Out<PositionType>) -> Result<i32, Stop> {
        if pos.is_null() {
            return Ok(-1);
        }
        pos.set(PositionType { x: 1.0, y: -2.5, phi: 0.25 });
        Ok(0)
    }
    fn LCDPutString(&self, s: Option<&[u8]>) -> Result<i32, Stop> {
        Ok(s.map_or(-1, |s| s.len() as i32))
    }
    fn OSVersion(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        Ok(text.set(b"6.5 of the simulator") as i32)
    }
    fn OSAttachTimer(&self, _: i32, f: Option<Callback>) -> Result<i32, Stop> {
        let Some(f) = f else { return Ok(0) };
        // SAFETY: called inside the call that passed it.
        unsafe { f.call() }?;
        Ok(7)
    }
    fn OSWait(&self, _: i32) -> Result<i32, Stop> {
        Err(Stop)
    }
    fn KEYGet(&self) -> Result<i32, Stop> {
        panic!("a mistake of the host")
    }
}

static TABLE: Robios6Table = Robios6Table::of::<Robot>();

fn context(robot: &Robot) -> *mut c_void {
    from_ref(robot).cast_mut().cast()
}

#[test]
fn call_reaches_its_method_and_returns_the_result() {
    let robot = Robot::default();
    let mut result = 99;
    // SAFETY: the robot lives, and the result can be written.
    let status = unsafe { (TABLE.VWDriveStraight)(context(&robot), 1, 0.5, 0.2, &mut result) };
    assert_eq!((status, result), (Status::OK, 0));
    assert_eq!(*robot.log.borrow(), ["VWDriveStraight(1, 0.5, 0.2) = 0"]);
}

#[test]
fn output_is_written_after_the_method_and_null_is_visible() {
    let robot = Robot::default();
    let (mut result, mut pos) = (99, PositionType::default());
    // SAFETY: the robot lives, and the results can be written.
    let status = unsafe { (TABLE.VWGetPosition)(context(&robot), 1, &mut pos, &mut result) };
    assert_eq!((status, result, pos), (Status::OK, 0, PositionType { x: 1.0, y: -2.5, phi: 0.25 }));
    // SAFETY: as above, and null is allowed.
    let status = unsafe { (TABLE.VWGetPosition)(context(&robot), 1, null_mut(), &mut result) };
    assert_eq!((status, result), (Status::OK, -1));
    assert_eq!(*robot.log.borrow(), ["VWGetPosition(1, &{1, -2.5, 0.25}) = 0", "VWGetPosition(1, NULL) = -1"]);
}

#[test]
fn text_keeps_every_byte_and_null_is_none() {
    let robot = Robot::default();
    let mut result = 99;
    // SAFETY: the robot lives, the text can be read, the result written.
    let status = unsafe { (TABLE.LCDPutString)(context(&robot), ByteSlice::from(&b"a\0\xff\n"[..]), &mut result) };
    assert_eq!((status, result), (Status::OK, 4));
    // SAFETY: as above, and null is allowed.
    let status = unsafe { (TABLE.LCDPutString)(context(&robot), ByteSlice::NULL, &mut result) };
    assert_eq!((status, result), (Status::OK, -1));
    assert_eq!(*robot.log.borrow(), [r#"LCDPutString("a\x00\xff\n") = 4"#, "LCDPutString(NULL) = -1"]);
}

#[test]
fn no_more_bytes_are_written_than_fit() {
    let robot = Robot::default();
    let mut buffer = *b"........";
    let mut result = 99;
    // SAFETY: the robot lives, and four of the eight bytes are offered.
    let status = unsafe { (TABLE.OSVersion)(context(&robot), ByteBuffer::from(&mut buffer[..4]), &mut result) };
    assert_eq!((status, result, &buffer), (Status::OK, 4, b"6.5 ...."));
}

#[test]
fn stop_writes_no_result() {
    let robot = Robot::default();
    let mut result = 99;
    // SAFETY: the robot lives, and the result can be written.
    let status = unsafe { (TABLE.OSWait)(context(&robot), 5, &mut result) };
    assert_eq!((status, result), (Status::STOP, 99));
    assert_eq!(*robot.log.borrow(), ["OSWait(5) stopped"]);
}

#[test]
fn a_panic_of_the_host_stops_the_program() {
    let robot = Robot::default();
    // SAFETY: the robot lives, and no result is wanted.
    let status = unsafe { (TABLE.KEYGet)(context(&robot), null_mut()) };
    assert_eq!(status, Status::STOP);
    assert_eq!(*robot.panics.borrow(), ["KEYGet"]);
}

#[test]
fn unimplemented_function_fails_as_documented() {
    let robot = Robot { is_quiet: true, ..Robot::default() };
    let mut result = 99;
    // SAFETY: the robot lives, and the result can be written.
    let status = unsafe { (TABLE.CAMInit)(context(&robot), 0, &mut result) };
    assert_eq!((status, result), (Status::OK, robios_sys::robios6::NOCAM));
    assert_eq!(*robot.missing.borrow(), ["CAMInit"]);
    assert!(robot.log.borrow().is_empty());
}

#[test]
fn without_a_robot_the_program_is_stopped() {
    // SAFETY: null is answered before anything is touched.
    assert_eq!(unsafe { (TABLE.LCDClear)(null_mut(), null_mut()) }, Status::STOP);
}

#[test]
fn callback_that_returns_stop_ends_the_call_in_progress() {
    unsafe extern "C" fn tick(data: *mut c_void) -> Status {
        // SAFETY: the test passed a counter that lives.
        let remaining = unsafe { &mut *data.cast::<i32>() };
        *remaining -= 1;
        if *remaining < 0 { Status::STOP } else { Status::OK }
    }
    let robot = Robot::default();
    let (mut remaining, mut result) = (1, 99);
    let timer = Callback { code: Some(tick), data: (&raw mut remaining).cast() };
    // SAFETY: the robot and the counter live, and the result can be written.
    let first = unsafe { (TABLE.OSAttachTimer)(context(&robot), 1, timer, &mut result) };
    assert_eq!((first, result), (Status::OK, 7));
    // SAFETY: as above.
    let second = unsafe { (TABLE.OSAttachTimer)(context(&robot), 1, timer, null_mut()) };
    assert_eq!(second, Status::STOP);
}

#[test]
fn calls_are_numbered_in_the_order_of_the_list() {
    for (index, call) in Robios6Call::ALL.iter().enumerate() {
        assert_eq!(call.index(), index);
        assert_eq!(Robios6Call::from_name(call.name()), Some(*call));
        assert!(Robios6Call::FAMILIES.iter().any(|family| family.name == call.family()));
    }
    assert_eq!(Robios6Call::VWDriveStraight.name(), "VWDriveStraight");
    assert_eq!(Robios6Call::VWDriveStraight.family(), "VW");
    assert_eq!(Robios6Call::VWDriveStraight.function().parameters[1].name, "delta_m");
    assert_eq!(size_of::<Robios6Table>(), 8 + Robios6Call::ALL.len() * size_of::<usize>());
}
