//! The pages about packs, their form and the trust in them.

use super::Kind;

/// Each code with its page, in the order of the alphabet.
pub(super) const PAGES: &[(&str, Kind, &str)] = &[
    (
        "E-PACK-ADDRESS",
        Kind::Usage,
        "An address of a pack is not of a form that can be used here.\n\
         Write a path, https://host/file.pack or oci://host/name:version. Addresses need a program that was built with --features share.",
    ),
    (
        "E-PACK-BYTES",
        Kind::Trust,
        "A registry gave other bytes than those whose digest it named: they were changed on the way or where they are kept.\n\
         Nothing was installed. Do not use them; get the pack from its author, whose signature says what is in it.",
    ),
    (
        "E-PACK-CAPABILITY",
        Kind::Input,
        "A pack holds code that it does not ask for, asks for code that it does not hold, or asks for what this engine does not have.\n\
         What can run must stand under [capabilities], under its own ending (.wasm, .so), so that everyone sees it before it runs.",
    ),
    (
        "E-PACK-CHOICE",
        Kind::Input,
        "The folder holds no pack of that name, or several, and none was chosen.\n\
         Choose one of those that the message lists: --name OWNER/NAME@VERSION.",
    ),
    (
        "E-PACK-CYCLE",
        Kind::Input,
        "Packs build on one another in a circle, so none of them could come first.\n\
         One of them must do without the other, or both take what they share from a third pack.",
    ),
    (
        "E-PACK-DEPENDS",
        Kind::Input,
        "A pack builds on another one, and no version that fits is at hand.\n\
         Nothing is fetched by itself: put the other pack and its signature beside this one, or name their folder with --from.",
    ),
    (
        "E-PACK-ENGINE",
        Kind::Input,
        "The pack is for other versions of the engine.\n\
         A behaviour is a claim about an engine too: get the version of the pack that fits, or the engine that it names.",
    ),
    (
        "E-PACK-ENTRY",
        Kind::Input,
        "A pack holds something else than plain files with harmless names: a link, a device, '..', a name that means something to a system.\n\
         engine pack build never writes such a thing, so somebody made it on purpose. Do not use the pack.",
    ),
    (
        "E-PACK-EVIDENCE",
        Kind::Input,
        "The pack carries no figures that could be measured again.\n\
         engine pack build measures them; a pack that was put together by hand has none.",
    ),
    (
        "E-PACK-FILE",
        Kind::Input,
        "There is no such file, or it is not an ordinary file.\n\
         Give the path of a file that ends in .pack.",
    ),
    (
        "E-PACK-FOLDER",
        Kind::Usage,
        "A folder is no pack's folder, is there already, or holds files that only 'engine pack build' makes.\n\
         engine pack new NAME makes a folder that is in order.",
    ),
    (
        "E-PACK-FORM",
        Kind::Input,
        "The file is not a pack in the one form that packs have: it is cut off, has bytes too many, or was written by another program.\n\
         There is only one way to write the same files as a pack, so that no reader can be shown something else than another. Get it again.",
    ),
    (
        "E-PACK-FORMAT",
        Kind::Input,
        "The pack was made for a newer engine, in a format that this one cannot read.\n\
         Use a newer engine.",
    ),
    (
        "E-PACK-HOME",
        Kind::Disk,
        "No folder is known where installed packs and trusted keys could stand.\n\
         Set ENGINE_DATA_DIR and ENGINE_CONFIG_DIR to folders, or HOME.",
    ),
    (
        "E-PACK-KEY",
        Kind::Input,
        "A key is missing, or the text is not a key.\n\
         Keys have the form of minisign: NAME.key is secret, NAME.pub is for everyone. engine pack keygen makes both.",
    ),
    (
        "E-PACK-KEY-USE",
        Kind::Usage,
        "The command cannot be carried out with this key: its file is there already, it needs a password that was not \
         given, or its owner was not named.\n\
         Give another name, add --password-stdin or --no-password, or write: engine pack trust OWNER --key KEY.",
    ),
    (
        "E-PACK-LIMIT",
        Kind::Input,
        "A pack is larger than packs can be: 64 MiB, 1,000 files, a manifest of 512 KiB;\n\
         or its evidence takes longer than evidence can: 100 seeds, 1,000,000 steps each, 10,000,000 in all.\n\
         The limits hold before anything is believed that the pack says of itself.",
    ),
    (
        "E-PACK-LIST",
        Kind::Input,
        "The files of a pack and its list of files are not the same.\n\
         An author adds the file to 'files' in pack.toml or removes it; a reader gets the pack again.",
    ),
    (
        "E-PACK-LOCK",
        Kind::Input,
        "engine.lock cannot be read: it was changed by hand, or by a newer engine.\n\
         Remove it and install the packs again; each is verified as if it were new.",
    ),
    (
        "E-PACK-MANIFEST",
        Kind::Input,
        "What a pack says of itself is not as it should be; the caret shows where.\n\
         An author corrects pack.toml; a reader should not use the pack.",
    ),
    (
        "E-PACK-MISSING",
        Kind::Input,
        "engine.lock names a pack that is not installed on this machine.\n\
         Install it from its file; the lock then decides whether it is the same one, byte for byte.",
    ),
    (
        "E-PACK-NAME",
        Kind::Usage,
        "A name is not one of a pack, or could mean more than one.\n\
         A pack is called owner/name in small letters, such as ada/wall. engine pack list shows what is installed.",
    ),
    (
        "E-PACK-NETWORK",
        Kind::Disk,
        "Something on the way to a registry or a server did not work; the message has the reason.\n\
         Nothing was installed. Check the address, the network and, for a private registry, that you are logged in.",
    ),
    (
        "E-PACK-POLICY",
        Kind::Input,
        "A pack lacks a policy, or carries one that does not fit its own behaviour.\n\
         That is its author's mistake: engine pack build puts the right one in.",
    ),
    (
        "E-PACK-ROBOT",
        Kind::Input,
        "The script of a pack names a robot whose body file the pack does not carry.\n\
         A stranger's script cannot reach the files on your disk: the author puts robots/NAME.toml into the pack.",
    ),
    (
        "E-PACK-STOPPED",
        Kind::Limit,
        "A measurement was stopped before every seed was done.\n\
         Half of it proves nothing, so nothing was written. Start it again.",
    ),
    (
        "E-PACK-VERSION",
        Kind::Input,
        "A registry has the pack that was asked for, but not this version of it.\n\
         The help lists the versions that it has; write one of them behind the colon of the address.",
    ),
    (
        "E-PACK-WORLD",
        Kind::Input,
        "A pack's script names a world that is not in the pack, nor in one that it builds on.\n\
         A stranger's script cannot reach the worlds on your disk: the author puts the file into worlds/ of the pack.",
    ),
    (
        "E-TRUST-CAPABILITY",
        Kind::Trust,
        "A pack asks for more than it was granted before.\n\
         Look at what it asks for with engine pack inspect. What you grant with --grant is written into engine.lock and not asked again.",
    ),
    (
        "E-TRUST-DIGEST",
        Kind::Trust,
        "A file is not the one that was meant: its digest differs from the manifest, the lock, or what you asked for.\n\
         It may be damaged or exchanged. Get it again; if that does not help, ask its author over another way.",
    ),
    (
        "E-TRUST-KEY",
        Kind::Trust,
        "A pack is signed by a key that you do not know.\n\
         Ask its owner for the public key over a way that you trust, then: engine pack trust OWNER --key KEY.",
    ),
    (
        "E-TRUST-KEY-CHANGED",
        Kind::Trust,
        "A pack is signed by another key than the packs of this owner were before.\n\
         The owner may have a new key, or somebody plays the owner. Ask over another way before you accept it.",
    ),
    (
        "E-TRUST-OWNER",
        Kind::Trust,
        "A pack of one owner is signed by a key that you trust for another owner only.\n\
         A key speaks for its own packs. Do not use this one.",
    ),
    (
        "E-TRUST-REVOKED",
        Kind::Trust,
        "A pack is signed by a key that you revoked.\n\
         That holds for all that it ever signed. Get a version that was signed by the owner's new key.",
    ),
    (
        "E-TRUST-ROLLBACK",
        Kind::Trust,
        "A statement of an owner on their keys is older than one that you have: a list of revoked keys with a lower number or an\n\
         earlier day, or a key that hands over a second time. Somebody may want you to forget what was said since.\n\
         Ask the owner for the newest one; engine pack trust lists what you have.",
    ),
    (
        "E-TRUST-SIGNATURE",
        Kind::Trust,
        "A signature is none, or does not fit the pack that it stands beside.\n\
         The pack or the signature was changed, or they belong to different packs. Get both again.",
    ),
    (
        "E-TRUST-STATEMENT",
        Kind::Trust,
        "A file is no signed statement on keys, or its signature does not fit. engine pack rotate and engine pack revoke write such\n\
         files. Get it again from its owner.",
    ),
    (
        "E-TRUST-STORE",
        Kind::Trust,
        "The list of trusted keys cannot be read, so nobody is trusted.\n\
         Look at trust.toml in the folder of the engine's configuration; a newer engine may have written it.",
    ),
    (
        "E-TRUST-UNSIGNED",
        Kind::Trust,
        "A pack has no signature: nobody says that it is what it claims to be.\n\
         Get its .minisig file and put it beside the pack, or accept that with --allow-unsigned.",
    ),
    (
        "E-TRUST-VERSION",
        Kind::Trust,
        "A pack is older than the version that is installed.\n\
         Who offers an old version may want its faults. If you want it yourself, add --allow-older.",
    ),
];
