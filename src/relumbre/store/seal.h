/// The first 512 bytes of a store: what it is, how long it is, and a hash of all the rest.
///
///   byte 0       16        20        24        32            40              504         512
///        ┌────────┬─────────┬─────────┬─────────┬─────────────┬───────────────┬───────────┐
///        │ magic  │ version │ 0       │ length  │ hash of     │ a line for    │ hash of   │ HDF5
///        ... │        │ u32     │         │ of file │ [512, end)  │ people        │ [0, 504)  │
///        └────────┴─────────┴─────────┴─────────┴─────────────┴───────────────┴───────────┘
///
/// HDF5 calls this space a user block and skips it, so any HDF5 reader opens a store. Relumbre
/// checks the seal before it lets HDF5 see a file: HDF5 then never parses damaged bytes.
/// All numbers little-endian; hashes are XXH64.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace relumbre {

inline constexpr std::size_t kSealBytes = 512;
inline constexpr std::uint32_t kStoreVersion = 1;

/// Hashes what `descriptor` (open for reading and writing) holds beyond the first 512 bytes and
/// writes the seal. `name` is what errors call the file. Returns the hash. Throws FileError.
std::uint64_t write_seal(int descriptor, const std::filesystem::path& name);

/// Reads the whole file once. Returns the hash of its contents. Throws FileError: cannot be opened,
/// is not a Relumbre store, is of another version (both are named), is truncated, was altered.
std::uint64_t verify_seal(const std::filesystem::path& file);

}  // namespace relumbre
