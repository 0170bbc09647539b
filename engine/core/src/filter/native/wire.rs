//! What the host of an isolated filter and its worker say to each other: a request, a reply, in turns.
//!
//! All numbers are little-endian. A request is one byte that names it, then its fields; a reply is one byte of status, the
//! length of its payload in four bytes, and the payload.

use std::io::{Error, ErrorKind, Read, Result, Write};

use filter_api::{Format, Frame, FrameMut, Mount, Moved};

use super::guarded::Guarded;
use super::loaded::{Failure, Native};
use super::wire_told::{read_kept, read_mount, read_moved, write_mount, write_moved};

/// The longest payload: a colour frame of 50 megapixels.
const LONGEST_PAYLOAD_BYTES: usize = 150_000_000;
const CREATE: u8 = 1;
const PROCESS: u8 = 2;
const MOUNT: u8 = 3;
const MOVED: u8 = 4;
const SAVE: u8 = 5;
const LOAD: u8 = 6;

/// What the host asks for.
pub(super) enum Request<'a> {
    /// An instance with these values; the reply says how many bytes it keeps.
    Create(&'a [f64]),
    /// To hear how the camera is mounted.
    Mount(&'a Mount),
    /// To hear how the robot moved.
    Moved(&'a Moved),
    /// What it keeps.
    Save,
    /// To go on from this.
    Load(&'a [u8]),
    /// A frame made from a frame.
    Process {
        /// The frame to read.
        input: Frame<'a>,
        /// The format of the frame to send back.
        writes: Format,
    },
}

/// What the worker answers.
#[derive(Debug, PartialEq)]
pub(super) enum Reply {
    /// It worked; the payload.
    Done(Vec<u8>),
    /// The filter refused, in its own words.
    Failed(String),
    /// The filter broke down, in its own words.
    Panicked(String),
}

pub(super) fn write_request(to: &mut impl Write, request: &Request<'_>) -> Result<()> {
    match request {
        Request::Create(values) => {
            to.write_all(&[CREATE])?;
            to.write_all(&(values.len() as u32).to_le_bytes())?;
            for value in *values {
                to.write_all(&value.to_le_bytes())?;
            }
        }
        Request::Mount(mount) => write_mount(to, MOUNT, mount)?,
        Request::Moved(moved) => write_moved(to, MOVED, moved)?,
        Request::Save => to.write_all(&[SAVE])?,
        Request::Load(kept) => {
            to.write_all(&[LOAD])?;
            to.write_all(&(kept.len() as u32).to_le_bytes())?;
            to.write_all(kept)?;
        }
        Request::Process { input, writes } => {
            to.write_all(&[PROCESS])?;
            let size = [input.width_px() as u32, input.height_px() as u32];
            for field in [size[0], size[1], input.format().bit(), writes.bit()] {
                to.write_all(&field.to_le_bytes())?;
            }
            to.write_all(input.pixels())?;
        }
    }
    to.flush()
}

pub(super) fn write_reply(to: &mut impl Write, reply: &Reply) -> Result<()> {
    let (status, payload) = match reply {
        Reply::Done(payload) => (0, payload.as_slice()),
        Reply::Failed(words) => (1, words.as_bytes()),
        Reply::Panicked(words) => (2, words.as_bytes()),
    };
    to.write_all(&[status])?;
    to.write_all(&(payload.len() as u32).to_le_bytes())?;
    to.write_all(payload)?;
    to.flush()
}

pub(super) fn read_reply(from: &mut impl Read) -> Result<Reply> {
    let [status] = read_array(from)?;
    let length = read_number(from)?;
    if length > LONGEST_PAYLOAD_BYTES || status > 2 {
        return Err(Error::new(ErrorKind::InvalidData, "not a reply"));
    }
    // What a worker promises takes no memory before it comes.
    let mut payload = Vec::new();
    if from.by_ref().take(length as u64).read_to_end(&mut payload)? < length {
        return Err(ErrorKind::UnexpectedEof.into());
    }
    let words = |payload: Vec<u8>| String::from_utf8_lossy(&payload).into_owned();
    Ok(match status {
        0 => Reply::Done(payload),
        1 => Reply::Failed(words(payload)),
        _ => Reply::Panicked(words(payload)),
    })
}

/// How many replies stand in bytes that a worker may have sent, up to the first that is none.
#[must_use]
pub fn count_replies(mut bytes: &[u8]) -> usize {
    std::iter::from_fn(|| read_reply(&mut bytes).ok()).count()
}

/// What a filter did with a call.
type Outcome<T> = std::result::Result<T, Failure>;

/// Answers requests until the host closes the channel. `create` makes an instance from its values.
pub(super) fn serve(
    from: &mut impl Read,
    to: &mut impl Write,
    create: impl Fn(&[f64]) -> Outcome<Native>,
) -> Result<()> {
    let mut instance = None;
    let (mut input, mut output, mut frames) = (Guarded::default(), Guarded::default(), 0_u8);
    let threads = threads();
    loop {
        let request = match read_array(from) {
            Ok([request]) => request,
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(()),
            Err(error) => return Err(error),
        };
        let done = match (request, &mut instance) {
            (CREATE, _) => {
                let count = read_number(from)?;
                let values =
                    (0..count).map(|_| Ok(f64::from_le_bytes(read_array(from)?))).collect::<Result<Vec<_>>>()?;
                create(&values).map(|made| (made.keeps() as u32, instance = Some(made)).0.to_le_bytes().to_vec())
            }
            (MOUNT, Some(instance)) => {
                let mount = read_mount(from)?;
                instance.mount(&mount).map(|()| Vec::new())
            }
            (MOVED, Some(instance)) => {
                instance.moved(&read_moved(from)?);
                Ok(Vec::new())
            }
            (SAVE, Some(instance)) => {
                let mut kept = vec![0; instance.keeps()];
                instance.save(&mut kept);
                Ok(kept)
            }
            (LOAD, Some(instance)) => instance.load(&read_kept(from)?).map(|()| Vec::new()),
            (PROCESS, Some(instance)) => {
                frames = frames.wrapping_add(1);
                // What a filter leaves out must not look the same twice: the law says that it fills every pixel.
                output.pixels_mut().fill(frames);
                process(from, instance, &mut input, &mut output)?.map(|()| output.pixels().to_vec())
            }
            _ => return Err(Error::new(ErrorKind::InvalidData, "not a request")),
        };
        let done = done.and_then(|payload| alone(threads).map(|()| payload));
        let reply = match done {
            Ok(payload) => Reply::Done(payload),
            Err(Failure { panicked: true, words }) => Reply::Panicked(words),
            Err(Failure { panicked: false, words }) => Reply::Failed(words),
        };
        write_reply(to, &reply)?;
    }
}

fn process(
    from: &mut impl Read,
    instance: &mut Native,
    input: &mut Guarded,
    output: &mut Guarded,
) -> Result<Outcome<()>> {
    let invalid = |words: String| Error::new(ErrorKind::InvalidData, words);
    let (width, height) = (read_number(from)?, read_number(from)?);
    let mut format = || -> Result<Format> {
        Format::from_bit(read_number(from)? as u32).ok_or_else(|| invalid("not a format".to_owned()))
    };
    let (reads, writes) = (format()?, format()?);
    input.resize(width * height * reads.channels());
    output.resize(width * height * writes.channels());
    from.read_exact(input.pixels_mut())?;
    let frame = Frame::new(width, height, reads, input.pixels()).map_err(|error| invalid(error.0))?;
    let to = FrameMut::new(width, height, writes, output.pixels_mut()).map_err(|error| invalid(error.0))?;
    let done = instance.process(frame, to);
    let overrun = output.overrun().map(|place| format!("it wrote outside of the frame that it is to fill, {place}"));
    let overrun =
        overrun.or_else(|| input.overrun().map(|place| format!("it wrote beside the frame that it reads, {place}")));
    Ok(overrun.map_or(done, |words| Err(Failure { panicked: true, words })))
}

/// The threads of this process, where the system tells them.
fn threads() -> Option<usize> {
    Some(std::fs::read_dir("/proc/self/task").ok()?.count())
}

/// Refuses a filter that has started a thread: what it does between calls is the same on no two machines.
fn alone(before: Option<usize>) -> Outcome<()> {
    let started = threads().zip(before).map_or(0, |(now, before)| now.saturating_sub(before));
    let words = format!("it started {started} threads that still run after the call: a filter works within its calls");
    if started == 0 { Ok(()) } else { Err(Failure { panicked: true, words }) }
}

pub(super) fn read_array<const N: usize>(from: &mut impl Read) -> Result<[u8; N]> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

pub(super) fn read_number(from: &mut impl Read) -> Result<usize> {
    Ok(u32::from_le_bytes(read_array(from)?) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reply_is_read_as_it_was_written() {
        for reply in [Reply::Done(vec![1, 2, 3]), Reply::Failed("no".to_owned()), Reply::Panicked(String::new())] {
            let mut bytes = Vec::new();
            write_reply(&mut bytes, &reply).unwrap();
            assert_eq!(read_reply(&mut bytes.as_slice()).unwrap(), reply);
        }
    }

    #[test]
    fn a_reply_that_promises_too_much_or_ends_early_is_refused() {
        assert!(read_reply(&mut [0, 255, 255, 255, 255].as_slice()).is_err());
        assert!(read_reply(&mut [3, 0, 0, 0, 0].as_slice()).is_err());
        assert!(read_reply(&mut [0, 4, 0, 0, 0, 1].as_slice()).is_err());
    }
}
