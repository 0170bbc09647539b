//! The pages about filters, their files and their sandbox, and about photographs.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "E-FILTER",
        Kind::Limit,
        "A filter could not work on an image that it was given.\n\
      The message says which image and what the filter said. Look at the filter's manual: engine plugins show NAME.",
    ),
    (
        "E-FILTER-BLIND",
        Kind::Input,
        "The filters leave no pixel of any image: not where the robot looks round from its starts and its route, nor in a few thousand \
      steps at random.\n\
      Every state would be the empty one, so nothing can be learned.\n\
      Lower the filter's threshold, look at the colour it searches for, or tilt the camera; engine filter shows what it makes of images.",
    ),
    (
        "E-FILTER-CRASH",
        Kind::Limit,
        "A native filter broke down: it panicked, crashed, left the process or took longer than two seconds for a frame.\n\
         The fault is in the filter; what was learned until then is kept. Without --isolate most crashes would end the engine too.\n\
         Tell the filter's author which frame it was, or learn without that filter.",
    ),
    (
        "E-FILTER-NAME",
        Kind::Input,
        "A file of filters must be called like the filter in it: ink.so or libink.so for the filter ink, ink.wasm for its sandboxed form.\n\
         So the engine knows which file to open without opening strangers' files. Rename the file, or the filter in its descriptor.",
    ),
    (
        "E-FILTER-SETTING",
        Kind::Input,
        "A filter chain cannot be built: a name or a parameter is wrong, or a filter reads another kind of picture than the one before it writes.\n\
      The last filter must write a mask, since the grid counts its pixels. engine plugins lists the filters with their parameters.",
    ),
    (
        "E-FILTER-SIZE",
        Kind::Limit,
        "The file of a filter is larger than a filter can need.\n\
         Look whether it is the right file; a library with debugging symbols becomes small when it is stripped.",
    ),
    (
        "E-FILTER-TWICE",
        Kind::Input,
        "Two filters have the same name, so a script could mean either of them.\n\
         Remove one of the files, or give one filter another name, in its descriptor and as the name of its file.",
    ),
    (
        "E-IMAGE-FILE",
        Kind::Input,
        "A photograph, or a folder of them, is missing or cannot be read.\n\
         Give PNG or JPEG files, or a folder that holds them directly; folders within it are not searched.",
    ),
    (
        "E-IMAGE-FORMAT",
        Kind::Input,
        "A file is called an image but is neither PNG nor JPEG inside.\n\
         Its name does not matter, its content does. Save the photograph as PNG or JPEG.",
    ),
    (
        "E-IMAGE-LIMIT",
        Kind::Input,
        "An image has more bytes or more pixels than are read: 64 MiB, 50 megapixels, 150 MB once it is decoded; 16 megapixels as a\n\
         progressive JPEG, whose decoder keeps every pixel twice more.\n\
         A small file can unpack into a huge picture, so the limit is checked first. Make the image smaller.",
    ),
    (
        "E-NATIVE-ABI",
        Kind::Input,
        "A native library is no filter that this engine can call: another kind of file, another machine, another version of the contract, or a part is missing.\n\
         It is refused before anything in it runs. Build it again on this machine with the contract of this engine: plugins/filter-api.",
    ),
    (
        "E-NATIVE-BUILD",
        Kind::Usage,
        "This engine was built without native filters.\n\
         Build it with its feature native-filters, which is on by default, or ask the author for the filter in WebAssembly.",
    ),
    (
        "E-NATIVE-DENIED",
        Kind::Trust,
        "A native filter can do all that you can do, from the moment it is loaded: read, change and send your files.\n\
         So none is loaded unless you name its digest. If you know where it comes from, paste the line of the message.\n\
         A filter in WebAssembly needs no such trust: ask the author for one.",
    ),
    (
        "E-NATIVE-DIGEST",
        Kind::Usage,
        "The digest that was allowed is not that of the file, or is not a whole digest.\n\
         A library gets another digest whenever it is built again. engine plugins --filter-dir DIR prints the present one.\n\
         If you did not build it again, somebody changed the file: do not allow it before you know who.",
    ),
    (
        "E-NATIVE-STATE",
        Kind::Limit,
        "A filter breaks the law of filters: one frame with one set of parameters gave two different outputs, or its mask holds other bytes than 0 and 255.\n\
         Learning with it could not be repeated. Tell its author; engine plugins check NAME shows the first frame that went wrong.",
    ),
    (
        "E-NEW",
        Kind::Usage,
        "The new filter cannot be written under this name or into this folder.\n\
         A name is made of lower case letters, digits and '_', must not be taken, and nothing that exists is ever overwritten.",
    ),
    (
        "E-PLUGIN",
        Kind::Usage,
        "There is no filter of this name. engine plugins lists those that there are, with their manuals.",
    ),
    (
        "E-RUN-FILTER",
        Kind::State,
        "The run was learned with a filter from a file, and the filter found now is another one.\n\
         Its states would mean something else. Give the folder with the same file, or learn the behaviour again.",
    ),
    (
        "E-TRUST-FILE",
        Kind::Input,
        "The file that allows native libraries cannot be understood.\n\
         It is TOML with one list: native = [\"sha256:...\"], each with all 64 digits.",
    ),
    (
        "E-WASM-ABI",
        Kind::Limit,
        "A WebAssembly module is no filter of this version of the contract: an export is missing, has another signature, or describes itself wrongly.\n\
         Build it again with filter_api::export!, or FILTER_EXPORT of filter.h, that belong to this engine.",
    ),
    (
        "E-WASM-BUILD",
        Kind::Usage,
        "This engine was built without WebAssembly, since that doubles the time it takes to build.\n\
         Build it with: cargo build --release --features wasm.",
    ),
    (
        "E-WASM-ENGINE",
        Kind::Limit,
        "The WebAssembly runtime cannot start on this machine, usually since it may not reserve memory.\n\
         Look at the limits of your shell: ulimit -v should be unlimited.",
    ),
    (
        "E-WASM-FORM",
        Kind::Limit,
        "The file is not a whole WebAssembly module.\n\
         It may be cut, be its text form (wat2wasm turns that into a module), or be something else under this name.",
    ),
    (
        "E-WASM-FUEL",
        Kind::Limit,
        "A sandboxed filter was stopped since it took more instructions than a filter may for one frame.\n\
         It may be in an endless loop, or too slow to learn with. The limit is the same on every machine; the law of filters has the numbers.",
    ),
    (
        "E-WASM-IMPORT",
        Kind::Limit,
        "A module asks for something outside of its sandbox: files, clocks, random numbers, or functions that are not there.\n\
         Filters may only import env.log. Build it for wasm32-unknown-unknown, without WASI.",
    ),
    (
        "E-WASM-MEM",
        Kind::Limit,
        "A sandboxed filter wanted more memory or larger tables than a filter may have, and was not started.\n\
         It may have 64 MiB. Build it with a smaller memory.",
    ),
    (
        "E-WASM-OUTPUT",
        Kind::Limit,
        "A sandboxed filter pointed outside of its own memory, or gave no memory for a frame.\n\
         It was stopped; nothing outside of the sandbox was touched. Tell its author.",
    ),
    (
        "E-WASM-SIZE",
        Kind::Limit,
        "A module is larger than what is compiled without knowing its author: code, functions, data or tables.\n\
         Build it for size: opt-level, strip, and without what it does not use.",
    ),
    (
        "E-WASM-STATE",
        Kind::Limit,
        "A sandboxed filter breaks the law of filters: one frame with one set of parameters gave two different outputs, or its mask holds other bytes than 0 and 255.\n\
         Learning with it could not be repeated. Tell its author.",
    ),
    (
        "E-WASM-TRAP",
        Kind::Limit,
        "A sandboxed filter broke down: it left its memory, divided by zero, or its functions called each other without end.\n\
         It was stopped, and nothing outside of the sandbox was touched. Tell its author which frame it was.",
    ),
];
