//! Answers calls that arrive as messages, from a robot's process or from code of the process that embeds the simulator.

use parking_lot::Mutex;
use robios_sys::wire::{Malformed, Reader, Request};
use robios_sys::{Callback, Robios6, Robios6Call, Robios7, Robios7Call, Status, Support, SupportCall};

use crate::program::site::RemoteSite;
use crate::robios::call::Call;

/// Carries out the call in `body`, the body of a CALL message, with the methods of `host`; appends the body of the
/// answer to `reply`.
///
/// Stores the location of the call in `site`, and passes the number of a RoBIOS call to `store_number`; `callback`
/// wraps a function of the program as a function of the host.
///
/// # Errors
/// [`Malformed`] if the bytes do not encode a call.
pub(super) fn answer<H: Support + Robios6 + Robios7>(
    host: &H,
    body: &[u8],
    site: &Mutex<RemoteSite>,
    store_number: impl Fn(u16),
    callback: &dyn Fn(u64, u64) -> Callback,
    reply: &mut Vec<u8>,
) -> Result<Status, Malformed> {
    let mut body = Reader::new(body);
    let (table, function): (u32, u32) = (body.get()?, body.get()?);
    let (address, line): (u64, u32) = (body.get()?, body.get()?);
    let file = body.bytes()?.unwrap_or_default();
    {
        let mut site = site.lock();
        (site.address, site.line) = (address, line);
        site.file.clear();
        site.file.push_str(&String::from_utf8_lossy(file));
    }
    let store_number = |call: Call| call.robios_number().into_iter().for_each(&store_number);
    let mut request = Request { arguments: body, callback };
    let function = function as usize;
    match table {
        SupportCall::TABLE => {
            let call = SupportCall::ALL.get(function).ok_or(Malformed)?;
            call.serve(host, &mut request, reply)
        }
        Robios6Call::TABLE => {
            let call = Robios6Call::ALL.get(function).ok_or(Malformed)?;
            store_number((*call).into());
            call.serve(host, &mut request, reply)
        }
        Robios7Call::TABLE => {
            let call = Robios7Call::ALL.get(function).ok_or(Malformed)?;
            store_number((*call).into());
            call.serve(host, &mut request, reply)
        }
        _ => Err(Malformed),
    }
}
