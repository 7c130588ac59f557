//! Calls encoded as bytes: a program in another process gets the same results as in the host's process.

use std::cell::RefCell;
use std::ffi::c_void;
use std::ptr::{from_ref, null_mut};

use robios_sys::robios6::{HDTEntry, IMAGE_COLUMNS, IMAGE_ROWS, Image, PositionType};
use robios_sys::wire::{HostConnection, Malformed, NULL, Plain as _, Reader, Request};
use robios_sys::{
    ByteBuffer, ByteSlice, CallContext, CallRecord, Callback, Out, OutBytes, Robios6, Robios6Call, Robios6Table,
    Status, Stop,
};

/// A host and the connection to it: every call and reply is encoded as bytes.
#[derive(Default)]
struct Robot {
    log: RefCell<Vec<String>>,
}

impl CallContext for Robot {
    fn is_logging(&self) -> bool {
        true
    }
    fn log_call(&self, record: &CallRecord<'_>) {
        self.log.borrow_mut().push(record.to_string());
    }
}

impl Robios6 for Robot {
    fn VWGetPosition(&self, _: i32, pos: &mut Out<PositionType>) -> Result<i32, Stop> {
        if pos.is_null() {
            return Ok(-1);
        }
        pos.set(PositionType { x: 1.0, y: -2.5, phi: 0.25 });
        Ok(0)
    }
    fn HDT_FindTable(&self, _: i32, index: i32, entry: &mut Out<HDTEntry>) -> Result<i32, Stop> {
        if index == 1 {
            entry.set(HDTEntry { type_id: 1, semantics: 2, name: *b"LEFT MOTOR\0\0\0\0\0\0" });
        }
        Ok(index)
    }
    fn LCDPutString(&self, s: Option<&[u8]>) -> Result<i32, Stop> {
        Ok(s.map_or(-1, |s| s.len() as i32))
    }
    fn OSVersion(&self, text: &mut OutBytes) -> Result<i32, Stop> {
        Ok(text.set(b"6.5 of the simulator") as i32)
    }
    fn IPLaplace(&self, src: Option<&Image>, dest: &mut Out<Image>) -> Result<i32, Stop> {
        let Some(src) = src else { return Ok(-1) };
        let mut reversed = *src;
        reversed.reverse();
        dest.set(reversed);
        Ok(0)
    }
    fn OSSemInit(&self, sem: Option<&mut i32>, val: i32) -> Result<i32, Stop> {
        let Some(sem) = sem else { return Ok(-1) };
        *sem += val;
        Ok(0)
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
}

extern "C" fn count(data: *mut c_void) -> Status {
    // SAFETY: the test passes its counter.
    unsafe { *data.cast::<i32>() += 1 };
    Status::OK
}

impl HostConnection for Robot {
    unsafe fn from_context<'a>(context: *mut c_void) -> Option<&'a Self> {
        // SAFETY: the tests pass their robot.
        unsafe { context.cast::<Self>().as_ref() }
    }
    fn exchange(&self, table: u32, function: u32, arguments: &dyn Fn(&mut Vec<u8>)) -> Result<Vec<u8>, Stop> {
        assert_eq!(table, 6);
        let (mut request, mut reply) = (Vec::new(), Vec::new());
        arguments(&mut request);
        let call = Robios6Call::ALL[function as usize];
        // Every truncation of the request is reported.
        for end in 0..request.len() {
            let mut truncated = Request { arguments: Reader::new(&request[..end]), callback: &|_, _| Callback::NONE };
            assert_eq!(
                call.serve(&Robot::default(), &mut truncated, &mut Vec::new()),
                Err(Malformed),
                "{}",
                call.name()
            );
        }
        let callback = |code: u64, data: u64| {
            assert_eq!(code, count as *const () as u64);
            Callback { code: Some(count), data: std::ptr::with_exposed_provenance_mut(data as usize) }
        };
        let mut request = Request { arguments: Reader::new(&request), callback: &callback };
        let status = call.serve(self, &mut request, &mut reply).expect("a request of ours");
        assert!(request.arguments.rest().is_empty());
        if status == Status::OK { Ok(reply) } else { Err(Stop) }
    }
}

static TABLE: Robios6Table = Robios6Table::remote::<Robot>();

fn context(robot: &Robot) -> *mut c_void {
    from_ref(robot).cast_mut().cast()
}

#[test]
fn outputs_are_returned_and_null_is_visible() {
    let robot = Robot::default();
    let (mut result, mut pos) = (99, PositionType::default());
    // SAFETY: the robot lives, and the results can be written; null is allowed.
    unsafe {
        assert_eq!((TABLE.VWGetPosition)(context(&robot), 1, &mut pos, &mut result), Status::OK);
        assert_eq!((result, pos), (0, PositionType { x: 1.0, y: -2.5, phi: 0.25 }));
        assert_eq!((TABLE.VWGetPosition)(context(&robot), 1, null_mut(), &mut result), Status::OK);
        assert_eq!(result, -1);
        assert_eq!((TABLE.VWGetPosition)(context(&robot), 1, &mut pos, null_mut()), Status::OK);
    }
    assert_eq!(robot.log.borrow()[..2], ["VWGetPosition(1, &{1, -2.5, 0.25}) = 0", "VWGetPosition(1, NULL) = -1"]);
    let mut entry = HDTEntry { type_id: 5, ..HDTEntry::default() };
    // SAFETY: as above.
    unsafe {
        assert_eq!((TABLE.HDT_FindTable)(context(&robot), 3, 0, &mut entry, &mut result), Status::OK);
        assert_eq!(entry.type_id, 5, "what was not set stays");
        assert_eq!((TABLE.HDT_FindTable)(context(&robot), 3, 1, &mut entry, &mut result), Status::OK);
    }
    assert_eq!((entry.semantics, &entry.name[..4]), (2, &b"LEFT"[..]));
}

#[test]
fn texts_images_and_buffers_are_transferred_completely() {
    let robot = Robot::default();
    let mut result = 99;
    let mut buffer = [b'x'; 8];
    let (mut image, mut reversed) = ([[0; IMAGE_COLUMNS]; IMAGE_ROWS], [[0; IMAGE_COLUMNS]; IMAGE_ROWS]);
    image[3][7] = 200;
    // SAFETY: the robot lives, and all pointers are valid or null.
    unsafe {
        assert_eq!((TABLE.LCDPutString)(context(&robot), ByteSlice::from("\u{e9}\0b"), &mut result), Status::OK);
        assert_eq!(result, 4);
        assert_eq!((TABLE.LCDPutString)(context(&robot), ByteSlice::NULL, &mut result), Status::OK);
        assert_eq!(result, -1);
        assert_eq!((TABLE.OSVersion)(context(&robot), ByteBuffer::from(&mut buffer[..3]), &mut result), Status::OK);
        assert_eq!((result, &buffer[..4]), (3, &b"6.5x"[..]));
        let nowhere = ByteBuffer { data: null_mut(), len: 3 };
        assert_eq!((TABLE.OSVersion)(context(&robot), nowhere, &mut result), Status::OK);
        assert_eq!(result, 0);
        assert_eq!((TABLE.IPLaplace)(context(&robot), &image, &mut reversed, &mut result), Status::OK);
        assert_eq!((result, reversed[IMAGE_ROWS - 4][7]), (0, 200));
        let mut sem = 40;
        assert_eq!((TABLE.OSSemInit)(context(&robot), &mut sem, 2, &mut result), Status::OK);
        assert_eq!(sem, 42);
        assert_eq!((TABLE.OSSemInit)(context(&robot), null_mut(), 2, &mut result), Status::OK);
        assert_eq!(result, -1);
    }
}

#[test]
fn a_callback_is_called_and_a_stopped_call_writes_no_result() {
    let robot = Robot::default();
    let (mut result, mut counter) = (99, 0);
    let callback = Callback { code: Some(count), data: (&raw mut counter).cast() };
    // SAFETY: the robot lives, the counter and the result can be written.
    unsafe {
        assert_eq!((TABLE.OSAttachTimer)(context(&robot), 1, callback, &mut result), Status::OK);
        assert_eq!((result, counter), (7, 1));
        assert_eq!((TABLE.OSAttachTimer)(context(&robot), 1, Callback::NONE, &mut result), Status::OK);
        assert_eq!((result, counter), (0, 1));
        assert_eq!((TABLE.OSWait)(context(&robot), 1, &mut result), Status::STOP);
        assert_eq!((TABLE.OSWait)(null_mut(), 1, &mut result), Status::STOP, "no connection");
    }
    assert_eq!(result, 0);
}

#[test]
fn numbers_are_little_endian_and_lengths_are_checked() {
    let mut bytes = Vec::new();
    (-2i32).put(&mut bytes);
    1.5f32.put(&mut bytes);
    assert_eq!(bytes, [0xfe, 0xff, 0xff, 0xff, 0, 0, 0xc0, 0x3f]);
    let mut reader = Reader::new(&[2, 0, 0, 0, 7]);
    assert_eq!(reader.bytes(), Err(Malformed));
    let null = NULL.to_le_bytes();
    assert_eq!(Reader::new(&null).bytes(), Ok(None));
}
