/// The file of a trace, `.rlt`: docs/trace.md has it byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "relumbre/archsim/trace.h"

namespace relumbre {

/// Compresses on all threads; the file appears whole or not at all. Beside the trace, memory for
/// the compressed file. Throws FileError.
void write_trace(const std::filesystem::path& file, const Trace& trace);

/// Throws FileError for what is no such file, truncated, damaged or of another version, whose reads
/// do not follow each other, and whose trace would need more than `max_bytes` of memory; that much
/// is known before anything is allocated. Decompresses and checks on all threads.
Trace read_trace(const std::filesystem::path& file,
                 std::uint64_t max_bytes = std::uint64_t{1} << 34);

/// The same of bytes in memory; `name` is for errors.
Trace parse_trace(std::span<const std::byte> bytes, const std::string& name,
                  std::uint64_t max_bytes = std::uint64_t{1} << 34);

}  // namespace relumbre
