#pragma once
/// Files of named arrays that are read in a process of their own: where the library that reads them
/// crashes, hangs or takes all memory, that process ends, and its end is an error message.
///
/// The process is a fork of this one that serves one file until the VariableFile goes. It has no
/// other file open and cannot open one, so nothing in the file makes it read another. It ends with
/// this process, whatever ends that. Numbers come back through shared memory.
///
/// Other threads may run meanwhile: the process uses nothing that they may hold locked, except the
/// library itself, which is locked here (Hdf5Lock). A program that calls HDF5 in other threads too
/// can make the process wait for ever; it is given up after a minute.

#include <cstdint>
#include <memory>
#include <string>

#include "notes.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

struct ApartLimits {
  /// Of the processor, for opening and for each read. The largest chunk that is read (256 MiB)
  /// inflates in one to two.
  double seconds{10.0};
  /// By the clock, where the disk is slow: half a minute is what network file systems wait.
  double patience{60.0};
  /// Beside what this process has: the largest chunk twice, and its caches.
  std::uint64_t bytes{std::uint64_t{1} << 30U};
};

/// `open` in a process of its own; `library` is what the messages call it ("the HDF5 library").
/// Throws what `open` throws, and base::InputError where the process ends; so does
/// VariableFile::read.
std::unique_ptr<VariableFile> open_apart(const std::string& path, Notes& notes,
                                         OpenVariableFile open, const std::string& library,
                                         const ApartLimits& limits = {});

}  // namespace hydrapod::data
