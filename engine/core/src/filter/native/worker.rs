//! Native filters in a process of their own: a crash, an endless loop or an `exit` ends the worker, not the learning.
//!
//! The host sends a request on the worker's standard input and waits for the reply on its standard output, with a deadline.
//! A worker holds one instance. Filters are pure, so a worker that died is replaced once and asked again.

use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use filter_api::{Descriptor, Frame, FrameMut, Mount, Moved};

use super::wire::{self, Reply, Request, read_reply, write_reply, write_request};
use super::{library, loaded};
use crate::diagnostic::{Diagnostic, Result, printable};
use crate::filter::described::{DescribedFilter, check_frames};
use crate::filter::entry::Entry;
use crate::filter::running::{Running, failed, refused, wrong_length};
use crate::filter::trust::Trust;

/// How long a library may take to load, or to create an instance.
const START: Duration = Duration::from_secs(5);
/// How long a filter may take for one frame.
const FRAME: Duration = Duration::from_secs(2);
/// What a filter did whose process ended with a status of its own.
const EXITED: &str = ": it left the program by itself, as with exit()";

/// Describes a library that the user allowed, in a worker that `program` starts as `program filter-worker LIBRARY`.
///
/// # Errors
/// If it is not allowed, is not a filter, or ends or stalls the worker while it is loaded.
pub(super) fn open(path: &Path, trust: &Trust, program: &Path) -> Result<Entry> {
    let (_, sha256) = library::read(path, trust)?;
    let launch = Launch { program: program.to_owned(), path: path.to_owned(), sha256: sha256.clone() };
    let (worker, described) = launch.start()?;
    drop(worker);
    let descriptor = described.check("E-NATIVE-ABI", path)?;
    let name = descriptor.name;
    let create = move |values: &[f64]| -> Result<Box<dyn Running>> {
        let (worker, keeps) = launch.create(name, values)?;
        let (launch, values) = (launch.clone(), values.to_vec());
        Ok(Box::new(Isolated { descriptor, launch, values, mount: None, worker, keeps, frames: 0 }))
    };
    Ok(Entry::native(descriptor, path, sha256, Box::new(create)))
}

/// How to start a worker for one library.
#[derive(Clone)]
struct Launch {
    program: PathBuf,
    path: PathBuf,
    sha256: String,
}

impl Launch {
    /// Starts a worker, which loads the library and says what is in it.
    fn start(&self) -> Result<(Worker, DescribedFilter)> {
        let mut worker = Worker::spawn(self)?;
        let shown = printable(&self.path.display().to_string());
        let broken = |why: String| {
            let message = format!("'{shown}' broke down while it was loaded: {why}");
            Box::new(Diagnostic::new("E-FILTER-CRASH", message))
        };
        let described = match worker.receive(START) {
            Ok(Reply::Done(described)) => described,
            Ok(Reply::Failed(words)) => {
                let (what, help) = words.split_once('\n').unwrap_or((&words, ""));
                let error = Diagnostic::new("E-NATIVE-ABI", printable(what));
                return error.help(printable(help)).fail();
            }
            Ok(Reply::Panicked(words)) => return Err(broken(printable(&words))),
            Err(why) => return Err(broken(why)),
        };
        let described = serde_json::from_slice(&described).map_err(|error| broken(error.to_string()))?;
        Ok((worker, described))
    }

    /// Starts a worker and creates its instance; how many bytes that keeps.
    fn create(&self, name: &str, values: &[f64]) -> Result<(Worker, usize)> {
        let (mut worker, _) = self.start()?;
        match worker.ask(&Request::Create(values), START) {
            Ok(Reply::Done(keeps)) => {
                let keeps = keeps.first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes));
                Ok((worker, keeps as usize))
            }
            Ok(Reply::Failed(words)) => Err(refused(&words)),
            Ok(Reply::Panicked(words)) | Err(words) => Err(failed("E-FILTER-CRASH", name, &words)),
        }
    }
}

/// A filter in a worker.
struct Isolated {
    descriptor: &'static Descriptor,
    launch: Launch,
    values: Vec<f64>,
    mount: Option<Mount>,
    worker: Worker,
    keeps: usize,
    frames: u64,
}

impl Isolated {
    /// The payload of the reply to a request.
    fn ask(&mut self, request: &Request<'_>) -> Result<Vec<u8>> {
        let (index, name) = (self.frames, self.descriptor.name);
        let crashed = |why: &str| failed("E-FILTER-CRASH", name, &format!("frame {index}: {why}"));
        let mut reply = self.worker.ask(request, FRAME);
        if reply.is_err() && !self.worker.late && self.keeps == 0 {
            // The same frame and parameters give the same output, so nothing is lost by asking another worker.
            self.worker = self.launch.create(name, &self.values)?.0;
            if let Some(mount) = &self.mount {
                self.worker.ask(&Request::Mount(mount), START).map_err(|why| crashed(&why))?;
            }
            reply = self.worker.ask(request, FRAME);
        }
        match reply {
            Ok(Reply::Done(payload)) => Ok(payload),
            Ok(Reply::Failed(words)) => Err(failed("E-FILTER", name, &words)),
            Ok(Reply::Panicked(words)) | Err(words) => Err(crashed(&words)),
        }
    }
}

impl Running for Isolated {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<()> {
        check_frames(self.descriptor, &input, &output)?;
        let request = Request::Process { input, writes: output.format() };
        let pixels = self.ask(&request)?;
        self.frames += 1;
        if pixels.len() != output.pixels().len() {
            let words = format!("frame {}: its worker sent a frame of another size", self.frames - 1);
            return Err(failed("E-FILTER-CRASH", self.descriptor.name, &words));
        }
        output.pixels().copy_from_slice(&pixels);
        Ok(())
    }

    fn mount(&mut self, mount: &Mount) -> Result<()> {
        self.mount = Some(*mount);
        self.ask(&Request::Mount(mount)).map(drop)
    }

    fn moved(&mut self, moved: &Moved) -> Result<()> {
        if self.keeps == 0 { Ok(()) } else { self.ask(&Request::Moved(moved)).map(drop) }
    }

    fn keeps(&self) -> usize {
        self.keeps
    }

    fn save(&mut self, kept: &mut [u8]) -> Result<()> {
        let saved = self.ask(&Request::Save)?;
        if saved.len() != kept.len() {
            return Err(wrong_length(self.descriptor.name, kept.len(), saved.len()));
        }
        kept.copy_from_slice(&saved);
        Ok(())
    }

    fn load(&mut self, kept: &[u8]) -> Result<()> {
        self.ask(&Request::Load(kept)).map(drop)
    }
}

/// A worker process, ended when it is dropped.
struct Worker {
    child: Child,
    input: ChildStdin,
    replies: Receiver<std::io::Result<Reply>>,
    /// Whether it missed a deadline, after which it is not asked again.
    late: bool,
}

impl Worker {
    fn spawn(launch: &Launch) -> Result<Self> {
        let mut command = Command::new(&launch.program);
        command
            .arg("filter-worker")
            .arg(format!("--allow-native=sha256:{}", launch.sha256))
            .arg("--")
            .arg(&launch.path);
        // What a filter prints is nobody's business; its replies go through a channel of their own.
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let failed = |error| Box::new(Diagnostic::disk("start the worker", &launch.program, &error));
        let mut child = command.spawn().map_err(failed)?;
        let (Some(input), Some(mut output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(failed(std::io::Error::other("it has no channels")));
        };
        let (sender, replies) = sync_channel(1);
        std::thread::spawn(move || {
            loop {
                let reply = read_reply(&mut output);
                let last = reply.is_err();
                if sender.send(reply).is_err() || last {
                    return;
                }
            }
        });
        Ok(Self { child, input, replies, late: false })
    }

    fn ask(&mut self, request: &Request<'_>, deadline: Duration) -> std::result::Result<Reply, String> {
        if write_request(&mut self.input, request).is_err() {
            return Err(self.ending());
        }
        self.receive(deadline)
    }

    /// The next reply, or why there is none.
    fn receive(&mut self, deadline: Duration) -> std::result::Result<Reply, String> {
        match self.replies.recv_timeout(deadline) {
            Ok(Ok(reply)) => Ok(reply),
            Err(RecvTimeoutError::Timeout) => {
                self.late = true;
                Err(format!("no answer in {} seconds, so its worker was stopped", deadline.as_secs()))
            }
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => Err(self.ending()),
        }
    }

    /// How the process ended.
    fn ending(&mut self) -> String {
        // It closed its channel; should it live on, it is of no use any more.
        let ended = self.child.try_wait().ok().flatten();
        let status = ended.or_else(|| {
            std::thread::sleep(Duration::from_millis(50));
            self.child.try_wait().ok().flatten()
        });
        status.map_or("its worker closed the channel".to_owned(), |status| {
            format!("its worker ended ({status}){}", if status.code().is_some() { EXITED } else { "" })
        })
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Both fail only if the process is gone already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The other side: loads a library, and serves requests from standard input until it is closed.
///
/// # Errors
/// If the library is not allowed or is no filter, or the host is gone.
pub fn serve(path: &Path, trust: &Trust) -> Result<()> {
    let lost = |error| Box::new(Diagnostic::disk("answer to", Path::new("the host"), &error));
    let mut output = replies_apart_from_prints().map_err(lost)?;
    let (bytes, _) = library::read(path, trust)?;
    let described = loaded::load(path, &bytes).and_then(|plugin| Ok((plugin, loaded::describe(plugin, path)?)));
    let (plugin, described) = match described {
        Ok(loaded) => loaded,
        Err(error) => {
            let words = format!("{}\n{}", error.message, error.help.as_deref().unwrap_or_default());
            write_reply(&mut output, &Reply::Failed(words)).map_err(lost)?;
            return Err(error);
        }
    };
    let words = serde_json::to_vec(&described).unwrap_or_default();
    write_reply(&mut output, &Reply::Done(words)).map_err(lost)?;
    let create = |values: &[f64]| loaded::Native::new(plugin, values);
    wire::serve(&mut std::io::stdin().lock(), &mut output, create).map_err(lost)
}

/// The channel for replies, taken away from standard output: what a filter prints there must not be taken for a reply.
#[cfg(unix)]
fn replies_apart_from_prints() -> std::io::Result<std::fs::File> {
    let channel = rustix::io::dup(std::io::stdout())?;
    rustix::stdio::dup2_stdout(std::io::stderr())?;
    Ok(channel.into())
}

#[cfg(not(unix))]
fn replies_apart_from_prints() -> std::io::Result<std::io::Stdout> {
    Ok(std::io::stdout())
}
