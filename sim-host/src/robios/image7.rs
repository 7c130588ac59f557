//! Image processing of RoBIOS-7: images of the size that a call passes, from and to buffers and files.

use robios_sys::robios7::{CUSTOM, RESOLUTIONS};
use robios_sys::{Out, OutBytes, Robios7Call as Call};

use super::picture::{self, Size};
use super::pnm;
use super::robot::Robot;

/// Returns true for a resolution: `QQVGA` to `CAM5MP`, and `CUSTOM`.
pub fn is_resolution(number: i32) -> bool {
    number == CUSTOM || RESOLUTIONS.iter().any(|(_, resolution, ..)| *resolution == number)
}

/// `IPSetSize`, `LCDImageSize`: only checks the resolution; each call with an image passes its own size.
pub fn set_resolution(robot: &mut Robot, call: Call, resolution: i32) -> i32 {
    if is_resolution(resolution) {
        return 0;
    }
    robot.refuse_call(call, 1, |_| {
        let names: Vec<&str> = RESOLUTIONS.iter().map(|(name, ..)| *name).collect();
        format!("{resolution} is not a resolution: expected {} or CUSTOM", names.join(", "))
    })
}

fn size_of([width, height]: [i32; 2]) -> Result<Size, String> {
    Size::new(width, height)
        .ok_or_else(|| format!("{width} x {height} is not a size of an image, which has at most the pixels of CAM5MP"))
}

/// The name of a file, if the program gives one.
fn given(name: Option<&[u8]>) -> Result<&[u8], String> {
    name.filter(|name| !name.is_empty()).ok_or_else(|| "the name of the file is empty".to_owned())
}

/// `IPReadFile`
pub fn read_file(robot: &mut Robot, name: Option<&[u8]>, size: [i32; 2], image: &mut OutBytes) -> i32 {
    let read = || {
        let size = size_of(size)?;
        if image.is_null() {
            return Err("there is no room for an image".to_owned());
        }
        let file = robot.robios.storage.read(given(name)?).map_err(|error| error.to_string())?;
        pnm::read(&file, size).map_err(|error| error.to_string())
    };
    match read() {
        Ok(picture) => {
            image.set(&picture.pixels);
            picture.kind.into()
        }
        Err(reason) => refuse_file(robot, Call::IPReadFile, -1, name, &reason),
    }
}

/// Encoder of an image file.
type Encode = fn(Size, &[u8]) -> Vec<u8>;

/// `IPWriteFile` (3 bytes per pixel), `IPWriteFileGray` (1 byte per pixel)
pub fn write_file(robot: &mut Robot, call: Call, name: Option<&[u8]>, size: [i32; 2], image: Option<&[u8]>) -> i32 {
    let (depth, encode): (_, Encode) =
        if call == Call::IPWriteFile { (3, pnm::write_colour) } else { (1, pnm::write_grey) };
    let mut write = || -> Result<(), String> {
        let size = size_of(size)?;
        let image = image.and_then(|image| image.get(..size.pixels() * depth)).ok_or("there is no image")?;
        let now = robot.now;
        robot.robios.storage.write(now, given(name)?, encode(size, image)).map_err(|error| error.to_string())
    };
    match write() {
        Ok(()) => 0,
        Err(reason) => refuse_file(robot, call, 1, name, &reason),
    }
}

fn refuse_file(robot: &mut Robot, call: Call, answer: i32, name: Option<&[u8]>, reason: &str) -> i32 {
    let name = super::text(name.unwrap_or_default()).into_owned();
    robot.refuse_call(call, answer, |_| format!("`{name}`: {reason}"))
}

/// `IPLaplace`, `IPSobel`: applies `operator` to a grey image of this size.
pub fn filter(
    robot: &mut Robot,
    call: Call,
    [width, height]: [i32; 2],
    source: Option<&[u8]>,
    result: &mut OutBytes,
    operator: fn(Size, &[u8]) -> Vec<u8>,
) {
    let size = Size::new(width, height);
    let source = size.zip(source).and_then(|(size, source)| Some((size, source.get(..size.pixels())?)));
    store(robot, call, [result], source.map(|(size, source)| [operator(size, source)]));
}

/// `IPCol2Gray` and the other pixelwise functions: stores `images`; `None` means that an argument was null or too
/// short.
pub fn store<const N: usize>(robot: &mut Robot, call: Call, results: [&mut OutBytes; N], images: Option<[Vec<u8>; N]>) {
    let is_null = results.iter().any(|result| result.is_null());
    match images {
        Some(images) if !is_null => results.into_iter().zip(&images).for_each(|(result, image)| _ = result.set(image)),
        _ => robot.skip_call(call, |_| "a null pointer, or an image shorter than its size".to_owned()),
    }
}

/// `IPPCol2RGB`, `IPPCol2HSI`, `IPPRGB2HSI`
pub fn put_channels(out: [&mut Out<u8>; 3], channels: [u8; 3]) {
    out.into_iter().zip(channels).for_each(|(out, channel)| out.set(channel));
}

/// The three channels of an image; `None` if one is null.
pub fn channels(channels: [Option<&[u8]>; 3]) -> Option<[&[u8]; 3]> {
    let [red, green, blue] = channels;
    Some([red?, green?, blue?])
}

/// `IPOverlayGray`
pub fn overlay_grey(under: Option<&[u8]>, over: Option<&[u8]>, colour: i32) -> Option<[Vec<u8>; 1]> {
    Some([picture::overlay_grey(under?, over?, picture::rgb_of_number(colour))])
}
