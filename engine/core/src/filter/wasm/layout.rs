//! The contract's structs as a 32-bit module lays them out, read out of its memory without trusting it.

use filter_api::abi::{ABI_VERSION, OLDEST_VERSION};

use crate::filter::described::{DescribedFilter, DescribedParameter, LONGEST_TEXT_BYTES, MOST_PARAMETERS};

/// Bytes of `filter_plugin`.
pub(super) const PLUGIN_BYTES: u32 = 96;
/// Bytes of what was `filter_plugin` in the first version of the contract.
pub(super) const FIRST_BYTES: u32 = 76;
/// Bytes of `filter_parameter`.
pub(super) const PARAMETER_BYTES: u32 = 56;
/// Bytes of `filter_frame`.
pub(super) const FRAME_BYTES: u32 = 20;
/// Bytes of `filter_mount`.
pub(super) const MOUNT_BYTES: u32 = 48;
/// Bytes of `filter_moved`.
pub(super) const MOVED_BYTES: u32 = 24;

/// What is wrong with the memory of a module.
#[derive(Debug, PartialEq)]
pub(super) enum Fault {
    /// An address points outside of its memory.
    Outside,
    /// Another version of the contract.
    Version(u32),
    /// Structs of other sizes.
    Sizes([u32; 3]),
    /// More parameters than there may be.
    Parameters(u32),
}

/// Reads the plugin at `address`.
pub(super) fn describe(memory: &[u8], address: u32) -> Result<DescribedFilter, Fault> {
    let field = |offset: u32| number(memory, address.checked_add(offset).ok_or(Fault::Outside)?);
    let text_at = |offset: u32| text(memory, address.checked_add(offset).ok_or(Fault::Outside)?);
    let version = field(0)?;
    if !(OLDEST_VERSION..=ABI_VERSION).contains(&version) {
        return Err(Fault::Version(version));
    }
    let plugin_bytes = if version == OLDEST_VERSION { FIRST_BYTES } else { PLUGIN_BYTES };
    let sizes = [field(4)?, field(8)?, field(12)?];
    if sizes != [plugin_bytes, PARAMETER_BYTES, FRAME_BYTES] {
        return Err(Fault::Sizes(sizes));
    }
    let (count, first) = (field(56)?, field(60)?);
    if count as usize > MOST_PARAMETERS {
        return Err(Fault::Parameters(count));
    }
    let address_of = |index: u32| first.checked_add(index * PARAMETER_BYTES).ok_or(Fault::Outside);
    Ok(DescribedFilter {
        name: text_at(16)?,
        version: text_at(24)?,
        licence: text_at(32)?,
        purpose: text_at(40)?,
        reads: field(48)?,
        writes: field(52)?,
        parameters: (0..count).map(|index| parameter(memory, address_of(index)?)).collect::<Result<_, _>>()?,
    })
}

fn parameter(memory: &[u8], address: u32) -> Result<DescribedParameter, Fault> {
    let start = address as usize;
    let bytes = memory.get(start..).and_then(|bytes| bytes.get(..PARAMETER_BYTES as usize)).ok_or(Fault::Outside)?;
    let real = |offset: usize| {
        let bytes = bytes.get(offset..).and_then(|bytes| bytes.first_chunk()).ok_or(Fault::Outside)?;
        Ok(f64::from_le_bytes(*bytes))
    };
    Ok(DescribedParameter {
        min: real(0)?,
        max: real(8)?,
        default: real(16)?,
        name: text(memory, address + 24)?,
        unit: text(memory, address + 32)?,
        purpose: text(memory, address + 40)?,
        kind: number(memory, address + 48)?,
    })
}

/// A text of a descriptor; what is too long to be one becomes an empty text, which no descriptor may have.
fn text(memory: &[u8], address: u32) -> Result<String, Fault> {
    let start = number(memory, address)? as usize;
    let length = number(memory, address.checked_add(4).ok_or(Fault::Outside)?)? as usize;
    if length > LONGEST_TEXT_BYTES {
        return Ok(String::new());
    }
    let bytes = memory.get(start..).and_then(|bytes| bytes.get(..length)).ok_or(Fault::Outside)?;
    Ok(String::from_utf8_lossy(bytes).into_owned())
}

/// The number of four bytes at `address`.
pub(super) fn number(memory: &[u8], address: u32) -> Result<u32, Fault> {
    let bytes = memory.get(address as usize..).and_then(|bytes| bytes.first_chunk()).ok_or(Fault::Outside)?;
    Ok(u32::from_le_bytes(*bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_outside_of_the_memory_are_faults_and_no_panic() {
        let mut memory = vec![0; 200];
        for (offset, number) in [(0, ABI_VERSION), (4, PLUGIN_BYTES), (8, PARAMETER_BYTES), (12, FRAME_BYTES)] {
            memory[100 + offset..104 + offset].copy_from_slice(&number.to_le_bytes());
        }
        assert_eq!(describe(&memory, 100).unwrap().name, "");
        for address in [150, 196, 197, 200, u32::MAX] {
            assert!(describe(&memory, address).is_err(), "{address}");
        }
        memory[156] = 1;
        memory[160..164].copy_from_slice(&190_u32.to_le_bytes());
        assert_eq!(describe(&memory, 100), Err(Fault::Outside));
        memory[156] = 65;
        assert_eq!(describe(&memory, 100), Err(Fault::Parameters(65)));
        (memory[156], memory[100], memory[104]) = (0, 1, FIRST_BYTES as u8);
        assert_eq!(describe(&memory, 100).unwrap().name, "");
        memory[104] = 0;
        assert_eq!(describe(&memory, 100), Err(Fault::Sizes([0, PARAMETER_BYTES, FRAME_BYTES])));
        memory[101] = 1;
        assert_eq!(describe(&memory, 100), Err(Fault::Version(257)));
    }
}
