#pragma once
/// A chunk of doubles packed as HDF5's filters shuffle and deflate pack it, faster than they do.
///
/// Shuffled, the chunk is eight planes: first bytes of all numbers, second bytes and so on. The low
/// bytes of computed numbers are random; deflate spends most of its time on them and gains nothing.
/// Each plane whose bytes have an entropy near eight bits is therefore stored as it is, inside the
/// same zlib stream, which any reader of HDF5 unpacks.

#include <span>
#include <vector>

namespace hydrapod::data {

/// The zlib stream; empty when zlib failed.
std::vector<unsigned char> packed_column(std::span<const double> numbers);

}  // namespace hydrapod::data
